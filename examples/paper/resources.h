// SPDX-License-Identifier: LGPL-3.0-or-later
/// Listings 4 and 7 of the paper: the interfaces of two resources.
#pragma once

#include <cstdint>

#include <mauve-plugins/types/imu.h>
#include <mauve-plugins/types/motion.h>
#include <mauve/element.h>

namespace paper {

struct PublisherShell : mauve::Shell {
  mauve::Property<std::string> topic{*this, "topic", ""};
};

/// It counts in place of publishing; plugin ros publishes.
template <typename T>
class PublisherCore final : public mauve::Core<PublisherShell> {
 public:
  mauve::Observable<std::uint64_t> published{*this, "published", 0, "values"};

  void publish(const T& /*value*/) { ++published; }  // [rt] in the thread of the writer
};

/// Listing 4. A service is a member that names a method of the core.
template <typename T>
struct PublisherInterface : mauve::Interface<PublisherCore<T>> {
  mauve::WriteService<T> write{*this, "write", &PublisherCore<T>::publish};
};

/// Listing 7, the core. Its methods run in the threads of the components that call, one at a time.
class EkfCore final : public mauve::Core<mauve::EmptyShell> {
 public:
  void update_imu(const rover::Imu& /*imu*/) { ++updates; }
  void update_pose(const rover::Pose& pose) {
    ++updates;
    pose_ = pose;
  }
  void update_twist(const rover::Twist& /*twist*/) { ++updates; }
  rover::MotionState predict() { return predict_at(mauve::to_seconds(mauve::job_time())); }
  rover::MotionState predict_at(double time) {
    rover::MotionState state;
    state.time = time;
    return state;
  }

  mauve::Observable<std::uint64_t> updates{*this, "updates", 0, "measurements"};

 private:
  mauve::Status on_configure() override { return mauve::ok(); }  // configure_hook of the paper
  void on_cleanup() override {}                                  // cleanup_hook

  rover::Pose pose_;
};

/// Listing 7, the interface.
struct EkfInterface : mauve::Interface<EkfCore> {
  mauve::WriteService<rover::Imu> update_imu{*this, "update_imu", &EkfCore::update_imu};
  mauve::WriteService<rover::Pose> update_pose{*this, "update_pose", &EkfCore::update_pose};
  mauve::WriteService<rover::Twist> update_twist{*this, "update_twist", &EkfCore::update_twist};
  mauve::ReadService<rover::MotionState> predict{*this, "predict", &EkfCore::predict};
  mauve::CallService<rover::MotionState(double)> predict_at{*this, "predict_at",
                                                            &EkfCore::predict_at};
};

}  // namespace paper
