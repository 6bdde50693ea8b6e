// SPDX-License-Identifier: LGPL-3.0-or-later
/// The socket in the file system: one daemon each, and no corpse in the way of the next one.
#pragma once

#include <filesystem>
#include <string>

#include <mauve/result.h>

namespace mauve::server {

/// A bound, listening Unix socket and the lock that makes it ours. [main]
class Endpoint {
 public:
  /// Makes the directory (0750) if it is missing, takes the lock PATH.lock, removes a socket at
  /// which no daemon answers, and binds with mode 0660. As root the group is `mauve` where it
  /// exists. Refuses with conflict when another daemon is there.
  [[nodiscard]] static Result<Endpoint> open(const std::filesystem::path& path);

  Endpoint(Endpoint&& other) noexcept;
  Endpoint& operator=(Endpoint&&) = delete;
  /// Removes the socket and gives the lock back.
  ~Endpoint();

  /// The listening descriptor, non-blocking; the caller owns it from here on.
  [[nodiscard]] int release_listener();
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  explicit Endpoint(std::filesystem::path path) : path_(std::move(path)) {}

  Status make_directory() const;
  Status take_lock();
  Status clear_dead_socket() const;
  Status bind_and_listen();

  std::filesystem::path path_;
  int lock_ = -1;
  int listener_ = -1;
  bool bound_ = false;
};

}  // namespace mauve::server
