// SPDX-License-Identifier: LGPL-3.0-or-later
/// A serial device read without ever waiting, and a pseudo-terminal that stands for one.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include <mauve/result.h>

namespace drivers {

/// Owns a file descriptor.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(other.number_) { other.number_ = -1; }
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor();

  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] bool open() const { return number_ >= 0; }

 private:
  int number_ = -1;
};

/// The path that `name` stands for: itself, or for "pty:NAME" the link of that name that this
/// process keeps for itself, in $RUNTIME_DIRECTORY, $XDG_RUNTIME_DIR or /tmp.
[[nodiscard]] std::string line_path(const std::string& name);

/// The reading end. A file or a FIFO serves as well: then baud and raw mode do not apply.
class SerialPort {
 public:
  /// What open() makes of a device that is not there.
  enum class Missing : bool { refused, accepted };

  /// Opens `device` (see line_path) raw and non-blocking; `baud` 0 leaves the speed alone. One that
  /// is not there yet can be accepted: it stays closed, for reopen() to try. [factory]
  mauve::Status open(const std::string& device, int baud, Missing missing = Missing::refused);
  void close() { device_ = Descriptor(); }
  /// The same once more, after it failed or was closed. Takes no memory. [rt]
  bool reopen();
  [[nodiscard]] bool is_open() const { return device_.open(); }
  /// Bytes that are there now; 0 when there are none, -1 when the device failed or hung up. Never
  /// waits. [rt]
  [[nodiscard]] std::ptrdiff_t read(std::span<char> into) const;

 private:
  Descriptor device_;
  std::string path_;
  int baud_ = 0;
  bool terminal_ = false;
};

/// A pseudo-terminal whose other end can be opened as a serial device under a name of our choice.
class PseudoTerminal {
 public:
  PseudoTerminal() = default;
  ~PseudoTerminal() { close(); }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  /// Creates the pair and, when `name` is not empty, a symbolic link to the device at its
  /// line_path(). A link that leads nowhere, or to a line of this process, is replaced; anything
  /// else there is refused. [factory]
  mauve::Status open(const std::string& name);
  void close();
  /// Path of the device.
  [[nodiscard]] const std::string& device() const { return path_; }
  /// Sends what fits and tells how many bytes that was. Never waits. [rt]
  [[nodiscard]] std::size_t send_some(std::string_view bytes) const;
  /// The same; what does not fit is lost, as on a real line nobody listens to. False: lost some.
  /// [rt]
  bool send(std::string_view bytes) const { return send_some(bytes) == bytes.size(); }
  /// What the other end wrote, as far as it fits; 0 when there is nothing. Never waits. [rt]
  [[nodiscard]] std::size_t receive(std::span<char> into) const;

 private:
  Descriptor master_;
  Descriptor slave_;  // kept open: else the pair hangs up whenever the reader closes
  std::string path_;
  std::string link_;
};

}  // namespace drivers
