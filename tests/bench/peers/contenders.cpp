// SPDX-License-Identifier: LGPL-3.0-or-later
#include "bench/peers/contenders.h"

namespace bench::peers {
namespace {

/// The build defines MAUVE_PEER_... where it found the packages of a peer.
#ifdef MAUVE_PEER_ROS
constexpr MakePeer kRos = make_ros;
#else
constexpr MakePeer kRos = nullptr;
#endif
#ifdef MAUVE_PEER_ICEORYX
constexpr MakePeer kIceoryx = make_iceoryx;
#else
constexpr MakePeer kIceoryx = nullptr;
#endif
#ifdef MAUVE_PEER_CYCLONE
constexpr MakePeer kCyclone = make_cyclone;
#else
constexpr MakePeer kCyclone = nullptr;
#endif

Contender other(const std::string& name, MakePeer make, const std::string& packages,
                const std::string& needs) {
  if (make == nullptr) {
    return {name, make,
            "Its packages were not found when this was built. Install them and build again: "
            "apt-get install " +
                packages};
  }
  if (make(100) == nullptr) return {name, make, "It did not come up: it needs " + needs + "."};
  return {name, make};
}

}  // namespace

std::vector<Contender> contenders() {
  return {
      {"raw loop", make_raw},
      {"mauve"},
      {"PI mutex", make_pi_mutex},
      {"triple buffer", make_triple_buffer},
      other("roscpp", kRos, "libroscpp-dev libstd-msgs-dev python3-rosmaster",
            "a ROS master, which scripts/bench starts"),
      other("iceoryx", kIceoryx, "libiceoryx-posh-dev libacl1-dev", "shared memory in /dev/shm"),
      other("Cyclone DDS", kCyclone, "cyclonedds-dev cyclonedds-tools", "the loopback interface")};
}

}  // namespace bench::peers
