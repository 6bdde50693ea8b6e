// SPDX-License-Identifier: LGPL-3.0-or-later
/// roscpp within one process: publish() of a pointer, which skips serialization; queues of one
/// message. The reader's thread calls the callback itself.
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_msgs/UInt8MultiArray.h>

#include <boost/make_shared.hpp>
#include <cstdlib>
#include <cstring>

#include "bench/peers/peer.h"

namespace bench::peers {
namespace {

class Ros : public Peer {
 public:
  explicit Ros(std::size_t size) : size_(size) {
    node_.setCallbackQueue(&queue_);
    publisher_ = node_.advertise<std_msgs::UInt8MultiArray>("mauve_peers", 1);
    subscriber_ = node_.subscribe("mauve_peers", 1, &Ros::arrived, this);
  }
  ~Ros() override { subscriber_.shutdown(); }

  /// The master has told each side of the other one.
  [[nodiscard]] bool connected() const {
    for (int tries = 0; tries < 200; ++tries) {
      if (publisher_.getNumSubscribers() > 0 && subscriber_.getNumPublishers() > 0) return true;
      ros::WallDuration(0.01).sleep();
    }
    return false;
  }
  void write(const void* data) override {
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    const auto message = boost::make_shared<std_msgs::UInt8MultiArray>();
    message->data.assign(bytes, bytes + size_);
    publisher_.publish(message);
  }
  void read(void* into) override {
    into_ = into;
    queue_.callAvailable(ros::WallDuration(0));
  }

 private:
  void arrived(const std_msgs::UInt8MultiArray::ConstPtr& message) {
    if (message->data.size() == size_) std::memcpy(into_, message->data.data(), size_);
  }

  std::size_t size_;
  void* into_ = nullptr;
  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
};

}  // namespace

std::unique_ptr<Peer> make_ros(std::size_t size) {
  if (!ros::isInitialized()) {
    if (std::getenv("ROS_MASTER_URI") == nullptr) return nullptr;
    ros::init(ros::M_string(), "mauve_peers",
              ros::init_options::NoSigintHandler | ros::init_options::NoRosout);
  }
  // A node handle waits for its master for ever.
  if (!ros::master::check()) return nullptr;
  static const ros::NodeHandle keeps_the_threads;
  auto peer = std::make_unique<Ros>(size);
  return peer->connected() ? std::move(peer) : nullptr;
}

}  // namespace bench::peers
