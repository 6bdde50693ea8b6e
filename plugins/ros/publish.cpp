// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resource kinds "ros/publish_TYPE": a value that is written to service `write` goes out on a
/// topic of ROS (paper, Listing 4). The writer puts it into a queue and goes on; the ROS thread of
/// this plugin converts and publishes it within some 5 ms. A value that the queue has no room for
/// is dropped and counted.
/// Example: "pose_topic": { "type": "ros/publish_pose", "properties": { "shell.topic": "/pose" } }
#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include <mauve/job.h>

#include "conversions.h"
#include "hub.h"
#include "outbox.h"
#include "parts.h"
#include "reports_master.h"
#include "stamps.h"

namespace ros_bridge {
namespace {

Clocks clocks_now() {
  return {mauve::job_time(), static_cast<std::int64_t>(ros::Time::now().toNSec())};
}

struct PublisherShell : mauve::Shell {
  mauve::Property<std::string> topic{*this, "topic", "", "where to publish"};
  mauve::Property<std::string> frame{*this, "frame", "map", "frame_id of messages with a header"};
};

/// The state of one publisher, as the ROS thread reports it.
struct PublisherCounts {
  mauve::Observable<std::uint64_t>& published;
  mauve::Observable<bool>& connected;
  mauve::Observable<int>& subscribers;
};

template <typename T>
class OutChannel final : public Channel {
 public:
  using Message = typename RosMessage<T>::Type;

  OutChannel(std::string topic, std::string frame, PublisherCounts counts)
      : topic_(std::move(topic)), frame_(std::move(frame)), counts_(counts) {}

  void open(ros::NodeHandle& node) override {
    publisher_ = node.advertise<Message>(topic_, kQueue, RosMessage<T>::kLatched);
    // A new master, or one that came late: its subscribers get the last message.
    if (RosMessage<T>::kLatched && any_) publisher_.publish(message_);
  }
  void close() override { publisher_.shutdown(); }
  void pump() override {
    while (outbox.take([this](mauve::Instant stamp, const T& value) { publish(stamp, value); })) {
    }
  }
  void report(bool connected) override {
    const int subscribers = publisher_ ? static_cast<int>(publisher_.getNumSubscribers()) : 0;
    while_wanted([&] {
      counts_.connected = connected;
      counts_.published += std::exchange(published_, 0U);
      counts_.subscribers = subscribers;
    });
  }

  Outbox<T> outbox{RosMessage<T>::kDepth};

 private:
  static constexpr std::uint32_t kQueue = 10;  // of roscpp, for each subscriber

  void publish(mauve::Instant stamp, const T& value) {
    RosMessage<T>::to(value, message_);
    if constexpr (requires { message_.header; }) {
      message_.header.frame_id = frame_.c_str();
      message_.header.stamp.fromNSec(static_cast<std::uint64_t>(to_wall(stamp, clocks_now())));
    }
    any_ = true;
    if (!publisher_) return;
    publisher_.publish(message_);
    ++published_;
  }

  std::string topic_;
  std::string frame_;
  PublisherCounts counts_;
  ros::Publisher publisher_;
  Message message_;
  bool any_ = false;
  std::uint64_t published_ = 0;
};

template <typename T>
class PublisherCore final : public mauve::Core<PublisherShell> {
 public:
  /// Lets `fill(T&)` write the next value where it will be published from. [rt]
  template <typename F>
  void publish(F&& fill) {
    master_.look(connected);
    if (!channel_->outbox.put(mauve::job_time(), fill)) ++dropped;
  }

 private:
  mauve::Stateless stateless{*this};
  mauve::Property<std::string> node{*this, "node", "mauve", "our name in ROS, one of a process"};
  mauve::Property<std::string> master{*this, "master", "",
                                      "http://host:port; empty: $ROS_MASTER_URI, or this machine"};
  mauve::Observable<std::uint64_t> published{*this, "published", 0, "messages given to ROS"};
  mauve::Observable<std::uint64_t> dropped{*this, "dropped", 0,
                                           "values that the queue did not hold"};
  mauve::Observable<bool> connected{*this, "connected", false, "registered with a master"};
  mauve::Observable<int> subscribers{*this, "subscribers", 0, "of the topic"};

  mauve::Status on_configure() override {
    if (mauve::Status good = check_topic(shell().topic); !good) return good;
    const mauve::Result<Node> who = node_of(node, master);
    if (!who) return who.error();
    auto channel = std::make_shared<OutChannel<T>>(
        shell().topic, shell().frame, PublisherCounts{published, connected, subscribers});
    if (mauve::Status joined = join(*who, channel); !joined) return joined;
    channel_ = std::move(channel);
    return mauve::ok();
  }
  void on_cleanup() override { leave(std::exchange(channel_, nullptr)); }

  std::shared_ptr<OutChannel<T>> channel_;
  ReportsMaster master_;
};

/// A write service that lets a large value be written in place.
template <typename T>
class PublishService final : public mauve::ServiceBase {
 public:
  PublishService(mauve::InterfaceBase& owner, std::string_view name)
      : ServiceBase(owner, name, mauve::Signature::write<T>()) {}

  bool write(const void* data) override {
    return publish([data](T& value) { value = *static_cast<const T*>(data); });
  }
  bool fill(mauve::Filler filler) override {
    return publish([&filler](T& value) { filler(&value); });
  }

 private:
  template <typename F>
  bool publish(F&& fill) {
    mauve::ScopedLock held(lock());
    if (!held) return false;
    static_cast<PublisherCore<T>&>(core()).publish(fill);
    return true;
  }
};

template <typename T>
struct PublisherInterface : mauve::Interface<PublisherCore<T>> {
  PublishService<T> write{*this, "write"};
};

template <typename T>
void declare_publisher(mauve::Plugin& plugin, std::string_view name) {
  plugin.resource<PublisherShell, PublisherCore<T>, PublisherInterface<T>>(name);
}

}  // namespace

void declare_publishers(mauve::Plugin& plugin) {
  declare_publisher<rover::Joystick>(plugin, "publish_joy");
  declare_publisher<rover::Point2D>(plugin, "publish_goal");
  declare_publisher<rover::Velocity>(plugin, "publish_velocity");
  declare_publisher<rover::LaserScan>(plugin, "publish_scan");
  declare_publisher<rover::Odometry>(plugin, "publish_odometry");
  declare_publisher<rover::Pose2D>(plugin, "publish_pose");
  declare_publisher<rover::Imu>(plugin, "publish_imu");
  declare_publisher<rover::OccupancyGrid>(plugin, "publish_map");
}

}  // namespace ros_bridge
