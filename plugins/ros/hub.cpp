// SPDX-License-Identifier: LGPL-3.0-or-later
#include "hub.h"

#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/ros.h>
#include <sys/prctl.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace ros_bridge {
namespace {

using mauve::Errc;
using mauve::refuse;
using mauve::Status;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kLookForMaster{500};
constexpr double kPumpSeconds = 0.005;

bool is_word(std::string_view text, std::string_view more) {
  const auto fits = [&](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || more.find(c) != more.npos;
  };
  return std::all_of(text.begin(), text.end(), fits);
}

/// "http://host:port" and nothing else.
bool is_master(std::string_view uri) {
  constexpr std::string_view kScheme = "http://";
  if (!uri.starts_with(kScheme)) return false;
  uri.remove_prefix(kScheme.size());
  if (uri.ends_with('/')) uri.remove_suffix(1);
  const std::size_t colon = uri.rfind(':');
  if (colon == uri.npos || colon == 0) return false;
  const std::string_view port = uri.substr(colon + 1);
  return is_word(uri.substr(0, colon), "-._") && !port.empty() && port.size() <= 5 &&
         std::all_of(port.begin(), port.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// The threads of roscpp are made by this one and inherit both: the name, and that signals are for
/// the threads of mauved.
void introduce() {
  prctl(PR_SET_NAME, "mauve-ros");
  sigset_t all;
  sigfillset(&all);
  for (const int own : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) sigdelset(&all, own);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

/// An exception of roscpp costs that one step only. Uncaught it would end the process, since this
/// is a thread of its own. False: `f` threw.
template <typename F>
bool guarded(F&& f) {
  try {
    f();
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

/// The state of the master, as we see it.
enum class Master : std::uint8_t { away, knows_us, knows_nothing };

class Hub {
 public:
  Status join(const Node& node, std::shared_ptr<Channel> channel) {
    const std::lock_guard lock(mutex_);
    if (node_ && *node_ != node) {
      return refuse(Errc::conflict, {},
                    "this process is ROS node '" + node_->name + "' of " + node_->master +
                        " already, and cannot be '" + node.name + "' of " + node.master + " too",
                    "give all ros resources the same core.node and core.master");
    }
    node_ = node;
    joining_.push_back(std::move(channel));
    ++members_;
    if (!running_) {
      running_ = true;
      std::thread([this] { run(); }).detach();
    }
    return mauve::ok();
  }

  void leave(const std::shared_ptr<Channel>& channel) {
    std::unique_lock lock(mutex_);
    channel->leave();
    if (--members_ > 0) return;
    // A master that swallows packets may hold the thread for minutes; it ends by itself then.
    ended_.wait_for(lock, std::chrono::seconds(1), [this] { return !running_ || members_ > 0; });
  }

 private:
  struct Member {
    std::shared_ptr<Channel> channel;
    bool open = false;
  };

  void run() {
    introduce();
    connected_ = false;
    next_look_ = {};
    while (take_members()) {
      guarded([this] { watch_master(); });
      guarded([this] { wait_for_messages(); });
      for (const Member& member : serving_) {
        guarded([&] { member.channel->pump(); });
        member.channel->report(connected_ && member.open);
      }
    }
  }

  void wait_for_messages() {
    if (node_handle_) {
      queue_.callAvailable(ros::WallDuration(kPumpSeconds));
    } else {
      std::this_thread::sleep_for(std::chrono::duration<double>(kPumpSeconds));
    }
  }

  /// Takes in the channels that came, and lets go those that left; false: none is left.
  bool take_members() {
    std::vector<std::shared_ptr<Channel>> joining;
    {
      const std::lock_guard lock(mutex_);
      joining.swap(joining_);
    }
    for (auto& channel : joining) serving_.push_back({std::move(channel)});
    if (!joining.empty()) next_look_ = {};
    std::erase_if(serving_, [](const Member& member) {
      if (member.channel->wanted()) return false;
      if (member.open) guarded([&] { member.channel->close(); });
      return true;
    });
    const std::lock_guard lock(mutex_);
    running_ = !serving_.empty() || !joining_.empty();
    if (!running_) ended_.notify_all();
    return running_;
  }

  /// Registers the topics that the master does not know: of a resource that came, or of all when
  /// the master is another one.
  void watch_master() {
    const Clock::time_point now = Clock::now();
    if (now < next_look_) return;
    next_look_ = now + kLookForMaster;
    const Master master = look_for_master();
    connected_ = master != Master::away;
    if (!connected_) return;
    for (Member& member : serving_) {
      if (member.open && master == Master::knows_nothing) {
        member.channel->close();
        member.open = false;
      }
    }
    for (Member& member : serving_) {
      // A topic is refused that has another type in this process: it is opened again.
      if (!member.open) member.open = guarded([&] { member.channel->open(*node_handle_); });
    }
  }

  Master look_for_master() {
    if (!ros::isInitialized()) initialise();
    // The node was ended (rosnode kill, or another one of its name): that is an order.
    if (ros::isStarted() && !ros::ok()) return Master::away;
    if (!ros::master::check()) return Master::away;
    if (!node_handle_) {
      if (!ros::isStarted()) ros::start();
      node_handle_.emplace();
      node_handle_->setCallbackQueue(&queue_);
    }
    XmlRpc::XmlRpcValue request;
    XmlRpc::XmlRpcValue response;
    XmlRpc::XmlRpcValue uri;
    request[0] = ros::this_node::getName();
    request[1] = ros::this_node::getName();
    return ros::master::execute("lookupNode", request, response, uri, false)
               ? Master::knows_us
               : Master::knows_nothing;
  }

  void initialise() {
    Node node;
    {
      const std::lock_guard lock(mutex_);
      node = *node_;
    }
    ros::console::set_logger_level(ROSCONSOLE_ROOT_LOGGER_NAME, ros::console::levels::Fatal);
    ros::console::notifyLoggerLevelsChanged();
    ros::init(ros::M_string{{"__master", node.master}}, node.name,
              ros::init_options::NoSigintHandler | ros::init_options::NoRosout);
    ros::Time::init();  // messages are stamped before there is a master, too
    ros::master::setRetryTimeout(ros::WallDuration(1.0));
  }

  std::mutex mutex_;
  std::condition_variable ended_;
  std::optional<Node> node_;
  std::vector<std::shared_ptr<Channel>> joining_;
  std::size_t members_ = 0;
  bool running_ = false;

  // The thread's own.
  std::vector<Member> serving_;
  ros::CallbackQueue queue_;
  std::optional<ros::NodeHandle> node_handle_;
  Clock::time_point next_look_{};
  bool connected_ = false;
};

/// Never destroyed: roscpp's threads may outlive main().
Hub& hub() {
  static Hub* const one = new Hub;
  return *one;
}

}  // namespace

mauve::Result<Node> node_of(const mauve::Property<std::string>& name,
                            const mauve::Property<std::string>& master) {
  const std::string& word = name;
  if (word.empty() || std::isalpha(static_cast<unsigned char>(word.front())) == 0 ||
      !is_word(word, "_")) {
    return mauve::invalid(name, "'" + word + "' is no name of a ROS node: letters, digits and _");
  }
  std::string uri = master;
  if (const char* const said = std::getenv("ROS_MASTER_URI"); uri.empty() && said != nullptr) {
    uri = said;
  }
  if (uri.empty()) uri = "http://localhost:11311";
  if (!is_master(uri)) {
    return mauve::invalid(master, "'" + uri + "' is no address of a ROS master: http://host:port");
  }
  return Node{word, uri};
}

Status check_topic(const mauve::Property<std::string>& topic) {
  const std::string& name = topic;
  const std::size_t begin = name.starts_with('/') ? 1 : 0;
  if (name.size() == begin || std::isalpha(static_cast<unsigned char>(name[begin])) == 0 ||
      !is_word(name, "_/") || name.ends_with('/') || name.find("//") != name.npos) {
    return mauve::invalid(topic, "'" + name + "' is no name of a ROS topic, such as /scan");
  }
  return mauve::ok();
}

Status join(const Node& node, std::shared_ptr<Channel> channel) {
  return hub().join(node, std::move(channel));
}

void leave(const std::shared_ptr<Channel>& channel) { hub().leave(channel); }

}  // namespace ros_bridge
