// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/shared_data.h>

#include <cstring>

#include <mauve/core.h>
#include <mauve/tap.h>

#include "model/succession.h"
#include "rt/latest_value.h"

namespace mauve {
namespace {

/// The exchange lives in the core: it is the inner data of the resource.
class SharedDataCore final : public CoreBase, public ValueStore {
 public:
  SharedDataCore(const DataType& data, std::shared_ptr<void> library)
      : data_(data), library_(std::move(library)), exchange_(data.size, SharedDataBase::kReaders) {}

  [[nodiscard]] const DataType& data() const override { return data_; }
  void each(const Visit& visit) const override {
    const rt::LatestValue::View newest = exchange_.newest();
    if (newest.data != nullptr) visit(newest.data, newest.header.stamp);
  }
  void put(const void* value, Instant stamp) override {
    std::memcpy(exchange_.begin_write(), value, data_.size);
    exchange_.end_write(stamp);
  }

  const DataType& data_;
  std::shared_ptr<void> library_;  // of the data type
  TapList taps_;
  rt::LatestValue exchange_;
  Stateless stateless_{*this};
};

Signature data_signature(PortKind kind, const DataType& data) {
  return {kind, data.name, data.layout, &data};
}

/// Readers with a slot of their own never wait; the others take turns under the lock.
class ReadLatest final : public ServiceBase {
 public:
  ReadLatest(InterfaceBase& owner, const DataType& data)
      : ServiceBase(owner, "read", data_signature(PortKind::read, data)) {}

  unsigned attach() override { return exchange().attach(); }
  void detach(unsigned slot) override { exchange().detach(slot); }
  [[nodiscard]] TapList* taps() override { return &shared().taps_; }

  DataStatus read(void* into, Cursor& cursor) override {
    rt::LatestValue& latest = exchange();
    auto copy = [&](const void* data) { std::memcpy(into, data, latest.size()); };
    if (cursor.slot == rt::LatestValue::kNoSlot) return in_turn(copy, cursor);
    return show(latest.acquire(cursor.slot), copy, cursor);
  }
  DataStatus look(Visitor visitor, Cursor& cursor) override {
    if (cursor.slot == rt::LatestValue::kNoSlot) return in_turn(visitor, cursor);
    return show(exchange().acquire(cursor.slot), visitor, cursor);
  }

 private:
  template <typename Visit>
  DataStatus in_turn(const Visit& visit, Cursor& cursor) {
    Entry entry(gate());
    if (!entry) return entry.refusal();
    return show(exchange().acquire(rt::LatestValue::kInTurn), visit, cursor);
  }
  template <typename Visit>
  static DataStatus show(const rt::LatestValue::View& view, const Visit& visit, Cursor& cursor) {
    if (view.data == nullptr) return DataStatus::no_data;
    visit(view.data);
    const bool fresh = view.header.sequence != cursor.seen;
    cursor.seen = view.header.sequence;
    cursor.stamp = view.header.stamp;
    return fresh ? DataStatus::new_data : DataStatus::old_data;
  }
  SharedDataCore& shared() { return static_cast<SharedDataCore&>(owner().core()); }
  rt::LatestValue& exchange() { return shared().exchange_; }
};

/// A writer that is alone never takes the lock. Others do, as does who fills a value in place
/// (the author's code), and everybody while somebody listens.
class WriteLatest final : public ServiceBase {
 public:
  WriteLatest(InterfaceBase& owner, const DataType& data)
      : ServiceBase(owner, "write", data_signature(PortKind::write, data)) {}

  [[nodiscard]] TapList* taps() override { return &shared().taps_; }

  bool write(const void* data) override {
    SharedDataCore& core = shared();
    if (owner().resource().gate().poisoned()) return false;
    const Instant stamp = job_time();
    if (core.taps_.empty() && core.exchange_.try_write(data, stamp)) {
      if (!core.taps_.empty()) tell(data, stamp);  // somebody began to listen meanwhile
      return true;
    }
    auto copy = [&](void* into) { std::memcpy(into, data, core.exchange_.size()); };
    return fill(Filler(copy));
  }
  bool fill(Filler filler) override {
    Entry entry(gate());
    if (!entry) return false;
    const Instant stamp = job_time();
    void* const value = shared().exchange_.begin_write();
    filler(value);
    shared().exchange_.end_write(stamp);
    shared().taps_.push(value, stamp);
    return true;
  }

 private:
  void tell(const void* data, Instant stamp) {
    const Entry entry(gate());
    if (entry) shared().taps_.push(data, stamp);
  }
  SharedDataCore& shared() { return static_cast<SharedDataCore&>(owner().core()); }
};

class SharedDataInterface final : public InterfaceBase {
 public:
  explicit SharedDataInterface(const DataType& data) : read_(*this, data), write_(*this, data) {}

 private:
  ReadLatest read_;
  WriteLatest write_;
};

ResourceType shared_data_type(const DataType& data, const std::shared_ptr<void>& library) {
  return {"shared_data", ShellType::of<EmptyShell>(),
          CoreType{"shared_data",
                   {},
                   [&data, library] { return std::make_shared<SharedDataCore>(data, library); }},
          [&data] { return std::make_shared<SharedDataInterface>(data); }};
}

}  // namespace

SharedDataBase::SharedDataBase(std::string name, const DataType& data, const void* initial,
                               std::shared_ptr<void> library)
    : ResourceBase(std::move(name), shared_data_type(data, library)) {
  gate().hold_shortly();
  if (initial != nullptr) write_service().write(initial);
}

}  // namespace mauve
