// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resource kinds "ros/subscribe_TYPE": the newest message of a topic of ROS, at service `read`
/// (paper 5.1.2). The ROS thread of this plugin converts it as it comes; readers never wait for it.
/// A message that holds no usable value is refused and counted. Before the first one `read` answers
/// no_data; give the connection a `max_age` where silence must be noticed.
/// Example: mauvectl get goal_topic.core.received
#include <ros/node_handle.h>
#include <ros/subscriber.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include <mauve/job.h>

#include "conversions.h"
#include "hub.h"
#include "inbox.h"
#include "parts.h"
#include "reports_master.h"
#include "stamps.h"
#include "types/silence.h"

namespace ros_bridge {
namespace {

struct SubscriberShell : mauve::Shell {
  mauve::Property<std::string> topic{*this, "topic", "", "what to subscribe to"};
};

/// The state of one subscriber, as the ROS thread reports it.
struct SubscriberCounts {
  mauve::Observable<std::uint64_t>& received;
  mauve::Observable<std::uint64_t>& dropped;
  mauve::Observable<std::uint64_t>& refused;
  mauve::Observable<bool>& connected;
  mauve::Observable<int>& publishers;
};

template <typename T>
class InChannel final : public Channel {
 public:
  using Message = typename RosMessage<T>::Type;

  InChannel(std::string topic, SubscriberCounts counts)
      : topic_(std::move(topic)), counts_(counts) {}

  void open(ros::NodeHandle& node) override {
    const boost::function<void(const boost::shared_ptr<const Message>&)> take =
        [this](const boost::shared_ptr<const Message>& message) { accept(*message); };
    subscriber_ = node.subscribe<Message>(topic_, kQueue, take);
  }
  void close() override { subscriber_.shutdown(); }
  void report(bool connected) override {
    const int publishers = subscriber_ ? static_cast<int>(subscriber_.getNumPublishers()) : 0;
    while_wanted([&] {
      counts_.connected = connected;
      counts_.publishers = publishers;
    });
  }

  Inbox<T> inbox;

 private:
  static constexpr std::uint32_t kQueue = 10;  // of roscpp; the newest are kept

  void accept(const Message& message) {
    const Clocks now{mauve::job_time(), static_cast<std::int64_t>(ros::Time::now().toNSec())};
    const auto fill = [&](T& value) {
      if (!RosMessage<T>::from(message, value)) return false;
      if constexpr (requires { value.time; }) value.time = time_of(message, now);
      return true;
    };
    bool replaced = false;
    last_ = std::max(last_ + 1, now.monotonic);
    const bool accepted = inbox.put(last_, fill, replaced);
    while_wanted([&] {
      ++(accepted ? counts_.received : counts_.refused);
      if (replaced) ++counts_.dropped;
    });
  }

  static double time_of(const Message& message, const Clocks& now) {
    std::int64_t stamp = 0;
    if constexpr (requires { message.header; }) {
      stamp = static_cast<std::int64_t>(message.header.stamp.toNSec());
    }
    return to_seconds(stamp, now);
  }

  std::string topic_;
  SubscriberCounts counts_;
  ros::Subscriber subscriber_;
  mauve::Instant last_ = 0;
};

/// Of a topic that says its last value again: no silence is a fault.
struct MayBeSilent {
  explicit MayBeSilent(mauve::Configurable& /*core*/) {}
};

template <typename T>
class SubscriberCore final : public mauve::Core<SubscriberShell> {
 public:
  /// [rt]
  const T* newest(mauve::Instant& stamp) {
    master_.look(connected);
    const T* const value = channel_->inbox.newest(stamp);
    if constexpr (!RosMessage<T>::kLatched) listen(value == nullptr ? 0 : stamp);
    return value;
  }

 private:
  mauve::Stateless stateless{*this};
  mauve::Property<std::string> node{*this, "node", "mauve", "our name in ROS, one of a process"};
  mauve::Property<std::string> master{*this, "master", "",
                                      "http://host:port; empty: $ROS_MASTER_URI, or this machine"};
  mauve::Observable<std::uint64_t> received{*this, "received", 0, "messages accepted"};
  mauve::Observable<std::uint64_t> dropped{
      *this, "dropped", 0, "messages that a newer one replaced before they were read"};
  mauve::Observable<std::uint64_t> refused{*this, "refused", 0, "messages without a usable value"};
  mauve::Observable<bool> connected{*this, "connected", false, "registered with a master"};
  mauve::Observable<int> publishers{*this, "publishers", 0, "of the topic"};

  mauve::Status on_configure() override {
    if (mauve::Status good = check_topic(shell().topic); !good) return good;
    const mauve::Result<Node> who = node_of(node, master);
    if (!who) return who.error();
    auto channel = std::make_shared<InChannel<T>>(
        shell().topic, SubscriberCounts{received, dropped, refused, connected, publishers});
    if (mauve::Status joined = join(*who, channel); !joined) return joined;
    channel_ = std::move(channel);
    return mauve::ok();
  }
  void on_cleanup() override { leave(std::exchange(channel_, nullptr)); }

  /// `newest`: when the newest message came; 0: none.
  void listen(mauve::Instant newest) {
    if (newest != heard_) {
      heard_ = newest;
      refused_before_ = refused;
      return silence_.ended();
    }
    if (!connected) return silence_.look("no ROS master knows its topic");
    if (publishers == 0) return silence_.look("nobody publishes its topic");
    if (refused != refused_before_) return silence_.look("its messages hold no usable value");
    silence_.look("its publishers send nothing");
  }

  std::shared_ptr<InChannel<T>> channel_;
  ReportsMaster master_;
  std::conditional_t<RosMessage<T>::kLatched, MayBeSilent, rover::Silence> silence_{*this};
  mauve::Instant heard_ = 0;          // when the last message came
  std::uint64_t refused_before_ = 0;  // when it was read
};

/// A read service with the time the message came, and in place for large values.
template <typename T>
class NewestService final : public mauve::ServiceBase {
 public:
  NewestService(mauve::InterfaceBase& owner, std::string_view name)
      : ServiceBase(owner, name, mauve::Signature::read<T>()) {}

  mauve::DataStatus read(void* into, mauve::Cursor& cursor) override {
    return show(cursor, [into](const T& value) { *static_cast<T*>(into) = value; });
  }
  mauve::DataStatus look(mauve::Visitor visitor, mauve::Cursor& cursor) override {
    return show(cursor, [&visitor](const T& value) { visitor(&value); });
  }

 private:
  template <typename F>
  mauve::DataStatus show(mauve::Cursor& cursor, F&& visit) {
    mauve::ScopedLock held(lock());
    if (!held) return held.refusal();
    mauve::Instant stamp = 0;
    const T* const value = static_cast<SubscriberCore<T>&>(core()).newest(stamp);
    if (value == nullptr) return mauve::DataStatus::no_data;
    visit(*value);
    const bool again = cursor.seen == static_cast<std::uint64_t>(stamp);
    cursor.seen = static_cast<std::uint64_t>(stamp);
    cursor.stamp = stamp;
    return again ? mauve::DataStatus::old_data : mauve::DataStatus::new_data;
  }
};

template <typename T>
struct SubscriberInterface : mauve::Interface<SubscriberCore<T>> {
  NewestService<T> read{*this, "read"};
};

template <typename T>
void declare_subscriber(mauve::Plugin& plugin, std::string_view name) {
  plugin.resource<SubscriberShell, SubscriberCore<T>, SubscriberInterface<T>>(name);
}

}  // namespace

void declare_subscribers(mauve::Plugin& plugin) {
  declare_subscriber<rover::Joystick>(plugin, "subscribe_joy");
  declare_subscriber<rover::Point2D>(plugin, "subscribe_goal");
  declare_subscriber<rover::Velocity>(plugin, "subscribe_velocity");
  declare_subscriber<rover::LaserScan>(plugin, "subscribe_scan");
  declare_subscriber<rover::Odometry>(plugin, "subscribe_odometry");
  declare_subscriber<rover::Pose2D>(plugin, "subscribe_pose");
  declare_subscriber<rover::Imu>(plugin, "subscribe_imu");
  declare_subscriber<rover::OccupancyGrid>(plugin, "subscribe_map");
}

}  // namespace ros_bridge
