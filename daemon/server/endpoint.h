// SPDX-License-Identifier: LGPL-3.0-or-later
/// The sockets in the file system: one daemon each, and no corpse in the way of the next one.
#pragma once

#include <sys/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include <mauve/result.h>

namespace mauve::server {

/// The way on which a client comes. `stop` is for stop, confirm and undo only, and viewers cannot
/// open it: they can neither fill its queue nor hold up the clients in it.
enum class Way : std::uint8_t { all, stop };

inline constexpr std::array<Way, 2> kWays = {Way::all, Way::stop};

/// Two bound, listening Unix sockets, PATH and PATH.stop, and the lock that makes them ours. The
/// second one is missing when its name is too long for a socket.
class Endpoint {
 public:
  /// [main] Makes the directory (0750) if it is missing, takes the lock PATH.lock, removes sockets
  /// at which no daemon answers, and binds with mode 0660. As root the group is `mauve` where it
  /// exists. Refuses with conflict when another daemon is there.
  [[nodiscard]] static Result<Endpoint> open(const std::filesystem::path& path);

  Endpoint(Endpoint&& other) noexcept;
  Endpoint& operator=(Endpoint&&) = delete;
  /// Removes the sockets and gives the lock back; what others put in their place stays.
  ~Endpoint();

  /// The listening descriptor, non-blocking; the caller owns it from here on. -1: there is none.
  [[nodiscard]] int release_listener(Way way);
  [[nodiscard]] const std::filesystem::path& path(Way way = Way::all) const { return at(way).path; }
  /// [any] Removes the names of the sockets that are still ours, when the process ends by force.
  void remove_names() const;
  /// [io] The name leads to our socket still.
  [[nodiscard]] bool is_there(Way way) const;
  /// [io] Makes the directory, the lock and the socket anew, where they are gone. The listener that
  /// was released before is not ours to close.
  [[nodiscard]] Status bind_again(Way way);

 private:
  struct Bound {
    std::filesystem::path path;
    int listener = -1;
    dev_t device = 0;
    ino_t inode = 0;  ///< 0: not bound
  };

  explicit Endpoint(const std::filesystem::path& path);

  [[nodiscard]] Bound& at(Way way) { return bound_.at(static_cast<std::size_t>(way)); }
  [[nodiscard]] const Bound& at(Way way) const { return bound_.at(static_cast<std::size_t>(way)); }
  [[nodiscard]] Status make_directory() const;
  [[nodiscard]] Status take_lock();
  [[nodiscard]] Status bind_and_listen(Way way);

  std::array<Bound, kWays.size()> bound_;
  int lock_ = -1;
};

}  // namespace mauve::server
