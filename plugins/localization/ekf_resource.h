// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resource kind "localization/ekf" (paper 5.3, Listing 7): the filter on the threads of its
/// callers, those that measure and those that read, one at a time. Services update_imu,
/// update_pose, update_twist, predict, predict_at, and `pose` for readers of pose2d/1. Example:
/// mauvectl get localization.core.dispersion localization.core.rejected_recently
///
/// Asking never moves the estimate. Before the filter knows a place `predict` has no data; `pose`
/// has none either without a heading, or when nothing was measured for `blind_after`.
#pragma once

#include <mauve/plugin.h>

#include <cstdint>
#include <optional>

#include "../types/silence.h"
#include "filter.h"

/// Opaque to tools; raise the revision when anything in it changes.
template <>
struct mauve::Described<localization::Memory> {
  static constexpr std::string_view name = "localization/2";
  static constexpr auto fields() { return std::tuple{}; }
};

namespace localization {

class EkfCore final : public mauve::Core<mauve::EmptyShell> {
 public:
  void update_imu(const rover::Imu& imu) { take(imu); }          // [rt]
  void update_pose(const rover::Pose& pose) { take(pose); }      // [rt]
  void update_twist(const rover::Twist& twist) { take(twist); }  // [rt]

  /// [rt] Now.
  std::optional<rover::MotionState> predict();
  /// [rt] At that time on the monotonic clock, s; 0: now. A state of time 0 means that there is
  /// none.
  rover::MotionState predict_at(double time);
  /// [rt] Now, for callers that need the pose only.
  std::optional<rover::Pose2D> pose();

 private:
  template <typename T>
  using Property = mauve::Property<T>;
  template <typename T>
  using Observable = mauve::Observable<T>;

  mauve::State<Memory> memory_{*this};

  Property<bool> start_known{*this, "start_known", false, "the robot stands at `start` at first"};
  Property<rover::Pose2D> start{*this, "start", {}, "in the local frame"};
  Property<double> start_deviation{*this,
                                   "start_deviation",
                                   0.1,
                                   "of x and y of the start",
                                   {.unit = "m", .min = 0.0, .max = 1e3}};
  Property<double> start_heading_deviation{*this,
                                           "start_heading_deviation",
                                           0.05,
                                           "of the heading of the start",
                                           {.unit = "rad", .min = 0.0, .max = 0.8}};
  mauve::Parameters<Parameters> parameters{*this};
  Property<double> window{*this,
                          "window",
                          0.5,
                          "measurements that are late by more are dropped",
                          {.unit = "s", .min = 0.0, .max = 60.0}};
  Property<double> blind_after{*this,
                               "blind_after",
                               1.0,
                               "without a measurement, service pose has no data",
                               {.unit = "s", .min = 0.01, .max = 60.0}};

  Observable<std::uint64_t> accepted{*this, "accepted", 0, "poses"};
  Observable<std::uint64_t> rejected{*this, "rejected", 0, "poses outside the gate"};
  Observable<int> rejected_recently{*this, "rejected_recently", 0, "of the last 16 poses"};
  Observable<std::uint64_t> reacquired{*this, "reacquired", 0,
                                       "times the filter gave in to what is outside the gate"};
  Observable<std::uint64_t> outliers{*this, "outliers", 0, "of wheels, gyroscope and compass"};
  Observable<std::uint64_t> late{*this, "late", 0, "measurements put in between"};
  Observable<std::uint64_t> too_late{*this, "too_late", 0, "measurements dropped for their age"};
  Observable<std::uint64_t> refused{*this, "refused", 0, "measurements that are none"};
  Observable<double> innovation{*this, "innovation", 0.0, "of the last pose, squared, normalised"};
  Observable<double> dispersion{*this, "dispersion", 0.0, "worst deviation of the place", "m"};
  Observable<double> pose_age{*this, "pose_age", 0.0, "since the last pose inside the gate", "s"};
  Observable<bool> placed{*this, "placed", false, "the place is known"};
  Observable<bool> aligned{*this, "aligned", false, "the heading is known"};
  rover::Silence silence_{*this};
  bool dropped_ = false;  // the last measurement was

  mauve::Status on_configure() override;

  [[nodiscard]] static double now() { return mauve::to_seconds(mauve::job_time()); }

  template <typename T>
  void take(T measurement) {
    const double time = now();
    if (measurement.time == 0.0) measurement.time = time;
    add(parameters, measurement, time, window, *memory_);
    show_counts(time);
  }
  void show_counts(double time);
  void tell(double time);
  Estimate estimate_at(double time);
};

struct EkfInterface : mauve::Interface<EkfCore> {
  mauve::WriteService<rover::Imu> update_imu{*this, "update_imu", &EkfCore::update_imu};
  mauve::WriteService<rover::Pose> update_pose{*this, "update_pose", &EkfCore::update_pose};
  mauve::WriteService<rover::Twist> update_twist{*this, "update_twist", &EkfCore::update_twist};
  mauve::ReadService<rover::MotionState> predict{*this, "predict", &EkfCore::predict};
  mauve::CallService<rover::MotionState(double)> predict_at{*this, "predict_at",
                                                            &EkfCore::predict_at};
  mauve::ReadService<rover::Pose2D> pose{*this, "pose", &EkfCore::pose};
};

}  // namespace localization
