// SPDX-License-Identifier: LGPL-3.0-or-later
// A plugin "sample" that is part of the test: every kind of element, port and service.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "mauve/plugin.h"

namespace sample {

struct Pose {
  double x = 0;
  double y = 0;
};
struct Scan {
  mauve::Bounded<float, 8> ranges;
};

}  // namespace sample

template <>
struct mauve::Described<sample::Pose> {
  static constexpr std::string_view name = "pose/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("x", &sample::Pose::x, "m"),
                      mauve::field("y", &sample::Pose::y, "m")};
  }
};
template <>
struct mauve::Described<sample::Scan> {
  static constexpr std::string_view name = "scan/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("ranges", &sample::Scan::ranges, "m")};
  }
};

namespace sample {

struct ControlShell : mauve::Shell {
  mauve::Property<std::string> device{*this, "device", "/dev/null", "where the robot is"};
  mauve::ReadPort<Pose> pose{*this, "pose"};
  mauve::ReadPort<Scan> scan{*this, "scan"};
  mauve::WritePort<Pose> command{*this, "command"};
  mauve::CallPort<double(double)> predict{*this, "predict"};
  mauve::EventPort<> reset{*this, "reset"};
};

class ControlCore : public mauve::Core<ControlShell> {
 public:
  using Contract = ControlCore;
  static constexpr const char* contract = "sample/control/1";
  virtual void update() = 0;
};

class Attract final : public ControlCore {
  mauve::Property<double> gain{*this, "gain", 0.2, "pull", {.unit = "1/s", .min = 0.0, .max = 2.0}};
  mauve::Property<std::int32_t> steps{*this, "steps", 4, "how many"};
  mauve::Property<Pose> home{*this, "home", {}, "where to go at the end"};
  void update() override {}
};
class Repel final : public ControlCore {
  mauve::Property<double> distance{*this, "distance", 0.8, "push starts here"};
  void update() override {}
};
/// A core of no plugin with a property that another core has too.
class Eager final : public ControlCore {
  mauve::Property<double> gain{*this, "gain", 2.0, "pull"};
  void update() override {}
};
class Throwing final : public ControlCore {
 public:
  Throwing() { throw std::runtime_error("out of order"); }
  void update() override {}
};
class Stranger final : public mauve::Core<ControlShell> {
 public:
  void update() {}
};

struct RelayShell : mauve::Shell {
  mauve::WritePort<Pose> next{*this, "next"};
};
class RelayCore final : public mauve::Core<RelayShell> {
 public:
  void take(const Pose& pose) { shell().next.write(pose); }
  Pose show() { return {}; }
  double predict(double seconds) { return seconds; }
  void reset() {}
};
struct RelayInterface : mauve::Interface<RelayCore> {
  mauve::Property<bool> strict{*this, "strict", false, "refuse doubtful values"};
  mauve::WriteService<Pose> write{*this, "write", &RelayCore::take};
  mauve::ReadService<Pose> read{*this, "read", &RelayCore::show};
  mauve::CallService<double(double)> predict{*this, "predict", &RelayCore::predict};
  mauve::EventService<> reset{*this, "reset", &RelayCore::reset};
};

using ControlFsm = mauve::PeriodicFsm<ControlCore>;

inline mauve::Plugin make_plugin() {
  mauve::Plugin plugin("sample");
  plugin.type<Pose>();
  plugin.type<Scan>();
  plugin.core<Attract>("attract");
  plugin.core<Repel>("repel");
  plugin.core<Throwing>("throwing");
  plugin.core<Stranger>("stranger");
  plugin.fsm<ControlFsm>("periodic");
  plugin.fsm<ControlFsm>("slow");
  plugin.component<ControlShell, ControlFsm>("control", "attract");
  plugin.component<ControlShell, ControlFsm>("bare");
  plugin.resource<RelayShell, RelayCore, RelayInterface>("relay");
  return plugin;
}

}  // namespace sample
