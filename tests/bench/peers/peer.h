// SPDX-License-Identifier: LGPL-3.0-or-later
/// A peer hands the newest value of one periodic thread to another thread of the same process. This
/// header includes nothing of mauve, since the headers of some peers need C++17.
#pragma once

#include <cstddef>
#include <memory>

namespace bench::peers {

class Peer {
 public:
  Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  virtual ~Peer() = default;

  /// Copies the value in; the writer's thread calls it.
  virtual void write(const void* data) = 0;
  /// Copies the newest value out, or leaves `into` as it is; the reader's thread calls it.
  virtual void read(void* into) = 0;
};

/// Values of `size` bytes. A result of nullptr says that the peer did not come up.
using MakePeer = std::unique_ptr<Peer> (*)(std::size_t size);

std::unique_ptr<Peer> make_raw(std::size_t size);
std::unique_ptr<Peer> make_pi_mutex(std::size_t size);
std::unique_ptr<Peer> make_triple_buffer(std::size_t size);
std::unique_ptr<Peer> make_ros(std::size_t size);
std::unique_ptr<Peer> make_iceoryx(std::size_t size);
std::unique_ptr<Peer> make_cyclone(std::size_t size);

}  // namespace bench::peers
