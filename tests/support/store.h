// SPDX-License-Identifier: LGPL-3.0-or-later
/// A resource in two contracts, for tests of the barrier: it counts the values that are written,
/// and those in the manner of the other contract. Its writers count the values that it accepted.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

namespace store {

/// Contract 1 takes numbers below 1000, contract 2 the others.
struct Total1 {
  double sum = 0;
  std::int64_t writes = 0;
};
struct Total2 {
  std::int64_t writes = 0;
  double sum = 0;
};

}  // namespace store

template <>
struct mauve::Described<store::Total1> {
  static constexpr std::string_view name = "store_total/1";
  static constexpr auto fields() {
    return std::tuple{field("sum", &store::Total1::sum), field("writes", &store::Total1::writes)};
  }
};
template <>
struct mauve::Described<store::Total2> {
  static constexpr std::string_view name = "store_total/2";
  static constexpr auto fields() {
    return std::tuple{field("writes", &store::Total2::writes), field("sum", &store::Total2::sum)};
  }
};

namespace store {

struct Counts {
  std::atomic<std::int64_t> written{0};  ///< by all writers, into either
  std::atomic<std::int64_t> wrong{0};    ///< into the one of the other contract
  std::atomic<bool> hold{false};         ///< writers of the component "held" stay in their job
  std::atomic<bool> holding{false};
};
inline Counts& counts() {
  static Counts all;
  return all;
}
inline void forget_counts() {
  counts().written = counts().wrong = 0;
  counts().hold = counts().holding = false;
}

struct NoPorts : mauve::Shell {};

template <typename Total, bool kLarge>
struct StoreCore : mauve::Core<NoPorts> {
  mauve::State<Total> state{*this};
  void add(const double& value) {
    if ((value >= 1000) != kLarge) ++counts().wrong;
    state->sum += value;
    ++state->writes;
  }
  double writes() { return static_cast<double>(state->writes); }
};

template <typename Old, typename Now>
void convert(const Old& old, Now& now) noexcept {
  now.sum = old.sum;
  now.writes = old.writes;
}

struct First : StoreCore<Total1, false> {
  mauve::Converts<Total2, Total1> back{state, convert<Total2, Total1>};
};
struct Second : StoreCore<Total2, true> {
  mauve::Converts<Total1, Total2> forth{state, convert<Total1, Total2>};
};
/// Of contract 2, and with the state of contract 1 as it is.
struct Same : StoreCore<Total1, true> {};
/// Of contract 2, knowing no other state.
struct Lone : StoreCore<Total2, true> {};

template <typename CoreT>
struct Face : mauve::Interface<CoreT> {
  mauve::WriteService<double> add{*this, "add", &CoreT::add};
  mauve::ReadService<double> writes{*this, "writes", &CoreT::writes};
};

template <typename CoreT>
std::shared_ptr<mauve::ResourceBase> make(const std::string& type) {
  return std::make_shared<mauve::ResourceBase>(
      "store",
      mauve::ResourceType{type, mauve::ShellType::of<NoPorts>(), mauve::CoreType::of<CoreT>(type),
                          mauve::detail::make<mauve::InterfaceBase, Face<CoreT>>});
}

struct WriterShell : mauve::Shell {
  mauve::WritePort<double> out{*this, "out", mauve::Safe{-1.0}};
};
/// Writes its value once each job.
struct Writer : mauve::Core<WriterShell> {
  mauve::Stateless stateless{*this};
  mauve::Property<double> value{*this, "value", 1.0, "written each job"};
  mauve::Property<bool> may_be_held{*this, "may_be_held", false,
                                    "stays in its job when the test says so"};
  void update() {
    while (may_be_held && counts().hold) {
      counts().holding = true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (shell().out.write(value)) ++counts().written;
  }
};
using WriterFsm = mauve::PeriodicFsm<Writer>;

struct Architecture : mauve::Architecture {
  mauve::Resource<NoPorts, First, Face<First>> resource{*this, "store"};
  mauve::Component<WriterShell, Writer, WriterFsm> left{*this, "left"};
  mauve::Component<WriterShell, Writer, WriterFsm> right{*this, "right"};

  mauve::Status on_configure() override {
    left.core().may_be_held = true;
    if (auto done = left.shell().out.connect(resource.interface().add); !done) return done;
    return right.shell().out.connect(resource.interface().add);
  }
};

/// Both writers go over to another store, and to its contract.
inline mauve::Change change_to(std::shared_ptr<mauve::ResourceBase> other, double value = 1000,
                               mauve::StatePolicy state = mauve::StatePolicy::keep) {
  mauve::Change change;
  for (const char* writer : {"left", "right"}) {
    mauve::Edit edit;
    edit.member = writer;
    edit.disconnect = {"out"};
    edit.connect = {{"out", "store.add", mauve::Duration{0}}};
    edit.properties.emplace_back("core.value", value);
    change.edits.push_back(std::move(edit));
  }
  change.remove = {"store"};
  change.new_resources.push_back({std::move(other), {}, state});
  change.sync = mauve::Sync::barrier;
  return change;
}

/// How many writes the store in force knows of.
inline double writes(const mauve::Architecture& architecture) {
  double value = -1;
  mauve::Cursor cursor;
  static_cast<void>(
      architecture.find_resource("store")->find_service("writes")->read(&value, cursor));
  return value;
}

}  // namespace store
