// SPDX-License-Identifier: LGPL-3.0-or-later
/// The one thread that talks to ROS, for all resources of this plugin.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include <mauve/property.h>

namespace ros {
class NodeHandle;
}

namespace ros_bridge {

/// One topic. All calls are the ROS thread's, unless another thread is named.
class Channel {
 public:
  virtual ~Channel() = default;

  /// Advertises or subscribes; again after close(). May wait for the master, and throw.
  virtual void open(ros::NodeHandle& node) = 0;
  virtual void close() = 0;
  /// Publishes the values that wait. Some hundred times a second, with or without a master.
  virtual void pump() {}
  /// Shows counters to the resource.
  virtual void report(bool connected) = 0;

  /// From now on no value is published or shown, and the topic will be closed. [factory]
  void leave() {
    const std::lock_guard lock(mutex_);
    wanted_ = false;
  }
  [[nodiscard]] bool wanted() const { return wanted_; }

 protected:
  /// Calls `f` unless the resource is gone. Never calls ROS in it: the resource's clean-up waits.
  template <typename F>
  void while_wanted(F&& f) {
    const std::lock_guard lock(mutex_);
    if (wanted_) f();
  }

 private:
  std::mutex mutex_;
  std::atomic<bool> wanted_{true};
};

/// Our node in ROS, and the address of its master.
struct Node {
  std::string name;
  std::string master;  ///< "http://host:port"

  friend bool operator==(const Node&, const Node&) = default;
};

/// The node of these properties; an empty master is that of the environment (ROS_MASTER_URI), or
/// the one of this machine. Refused: values for which roscpp would end the process. [factory]
mauve::Result<Node> node_of(const mauve::Property<std::string>& name,
                            const mauve::Property<std::string>& master);

/// Is it a name of a topic?
mauve::Status check_topic(const mauve::Property<std::string>& topic);

/// The thread serves this channel from now on. A process is one node: refused when it is another
/// one already. [factory]
mauve::Status join(const Node& node, std::shared_ptr<Channel> channel);

/// The thread closes this channel; when it was the last one, waits up to a second for the thread to
/// end. [factory]
void leave(const std::shared_ptr<Channel>& channel);

}  // namespace ros_bridge
