// SPDX-License-Identifier: LGPL-3.0-or-later
/// The paper's ROS column, with roscpp:
///   `paper_ros cycles NAME PERIOD_US TIME_US COUNT`  a node with a loop and a ros::Rate, as in the
///       paper; it prints "NAME start end" for each cycle.
///   `paper_ros exchange SIZE COUNT`  a node that publishes to itself each 20 ms; it prints the ns
///       of publish() and until the callback.
/// The program needs a master (ROS_MASTER_URI). No header of ours: nothing else is linked.
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_msgs/UInt8MultiArray.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <time.h>

namespace {

long long read_clock(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<long long>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}
long long now() { return read_clock(CLOCK_MONOTONIC); }

void compute(long long time) {
  const long long end = read_clock(CLOCK_THREAD_CPUTIME_ID) + time;
  while (read_clock(CLOCK_THREAD_CPUTIME_ID) < end) {
  }
}

int run_cycles(int argc, char** argv) {
  if (argc < 6) return 2;
  const std::string name = argv[2];
  ros::init(argc, argv, "paper_" + name, ros::init_options::NoSigintHandler);
  ros::NodeHandle node;
  const long long time = std::atoll(argv[4]) * 1000;
  const auto count = static_cast<std::size_t>(std::atoi(argv[5]));
  std::vector<std::pair<long long, long long>> cycles;
  cycles.reserve(count);
  ros::Rate rate(1e6 / std::atof(argv[3]));
  while (ros::ok() && cycles.size() < count) {
    const long long start = now();
    compute(time);
    cycles.emplace_back(start, now());
    rate.sleep();
  }
  for (const auto& [start, end] : cycles) std::printf("%s %lld %lld\n", name.c_str(), start, end);
  return 0;
}

int run_exchange(int argc, char** argv) {
  if (argc < 4) return 2;
  ros::init(argc, argv, "paper_exchange", ros::init_options::NoSigintHandler);
  ros::NodeHandle node;
  long long sent = 0;
  long long arrived = 0;
  const auto publisher = node.advertise<std_msgs::UInt8MultiArray>("paper_exchange", 1);
  const auto on_message = [&](const std_msgs::UInt8MultiArray::ConstPtr&) { arrived = now(); };
  const ros::Subscriber subscriber = node.subscribe<std_msgs::UInt8MultiArray>(
      "paper_exchange", 1, on_message, {}, ros::TransportHints().tcpNoDelay());
  std_msgs::UInt8MultiArray message;
  message.data.resize(static_cast<std::size_t>(std::atoi(argv[2])));
  ros::Rate rate(50);
  const int count = std::atoi(argv[3]);
  for (int done = 0, attempts = 0; ros::ok() && done < count && attempts < count + 100;
       ++attempts) {
    arrived = 0;
    sent = now();
    publisher.publish(message);
    const long long published = now() - sent;
    const long long enough = sent + 500'000'000;
    while (arrived == 0 && now() < enough && ros::ok()) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
    }
    if (arrived != 0) {
      ++done;
      std::printf("%lld %lld\n", published, arrived - sent);
    }
    rate.sleep();
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "cycles") return run_cycles(argc, argv);
  if (what == "exchange") return run_exchange(argc, argv);
  std::fprintf(stderr, "usage: paper_ros cycles NAME PERIOD_US TIME_US COUNT | exchange SIZE N\n");
  return 2;
}
