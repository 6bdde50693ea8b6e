// SPDX-License-Identifier: LGPL-3.0-or-later
/// A serial device, read and written as far as it goes now, and a pseudo-terminal that stands for
/// one.
#pragma once

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <mauve/guarded.h>
#include <mauve/result.h>

#include <mauve/serial/device_lock.h>

namespace mauve::serial {

/// Owns a file descriptor.
class Descriptor {
 public:
  Descriptor() = default;
  /// Takes it over; a negative number is none.
  explicit Descriptor(int number) : number_(number) {}
  /// Takes it from the other one.
  Descriptor(Descriptor&& other) noexcept : number_(other.number_) { other.number_ = -1; }
  /// Exchanges them.
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor();

  [[nodiscard]] int number() const { return number_; }      ///< negative: none
  [[nodiscard]] bool open() const { return number_ >= 0; }  ///< there is one

 private:
  int number_ = -1;
};

/// The errno of a device that another component of this process has.
inline constexpr int kOfAnotherComponent = EALREADY;
/// The errno of a device that nothing guards, though it is to be guarded.
inline constexpr int kNotGuarded = EPERM;

/// The path that `name` stands for: itself, or for "pty:NAME" the link of that name that this
/// process keeps for itself, in $RUNTIME_DIRECTORY, $XDG_RUNTIME_DIR or /tmp.
[[nodiscard]] std::string line_path(const std::string& name);

/// One end of a line. Nothing here waits for bytes, but the kernel may let any caller wait for one
/// of its own threads: real-time threads leave it to a LineThread. That calls write() and tune()
/// also while another thread is in read(); read() leaves number() as it is.
class LineEnd {
 public:
  virtual ~LineEnd() = default;

  /// The descriptor; -1: it is closed.
  [[nodiscard]] virtual int number() const = 0;
  /// Bytes that are there now; 0 when there are none, -1 when the device failed or hung up.
  [[nodiscard]] virtual std::ptrdiff_t read(std::span<char> into) = 0;
  /// Bytes that found room; -1 when the device failed.
  [[nodiscard]] virtual std::ptrdiff_t write(std::string_view bytes) const = 0;
  /// The device is not used from now on.
  virtual void close() = 0;
  /// The same once more, after it failed or was closed. False with errno set. Takes no memory.
  virtual bool reopen() = 0;
  /// The name under which others may open the same device; empty: no other can.
  [[nodiscard]] virtual std::string name() const { return {}; }
  /// Gives the device the settings of this end, in place of any others; false when it has none.
  virtual bool tune() { return false; }
  /// How often a safe order overruled all that was sent before, counted on and on. [rt]
  [[nodiscard]] virtual std::uint8_t times_overruled() const { return 0; }
  /// Something from before may have come after that order: it is sent again.
  virtual void repeat_order() {}
  /// A line of another component waits for the device.
  [[nodiscard]] virtual bool is_awaited() const { return false; }
};

/// The device's end. For reading alone a file or a FIFO serves as well: then baud and raw mode do
/// not apply.
class SerialPort final : public LineEnd {
 public:
  /// The treatment of a device that is not there, by open().
  enum class Missing : bool { refused, accepted };
  /// A device that is no terminal is never written to: a request would damage a recording.
  enum class Use : bool { reading, both };

  /// Takes `device` from now on for this process alone (device_lock.h); refused while another one
  /// has it. Opens it (see line_path) raw and non-blocking, at the speed it has until tune();
  /// `baud` 0 leaves it alone for good. One that is not there yet can be accepted: it stays closed,
  /// for reopen() to try. [factory]
  mauve::Status open(const std::string& device, int baud, Missing missing = Missing::refused,
                     Use use = Use::reading);
  /// While the device is open, the guardian of the process holds this order for it, unless it is a
  /// "pty:NAME", which ends with the process. Before open(); `guarded` outlives the port. [factory]
  void guard(mauve::Guarded& guarded, const mauve::SafeOrder& order);
  /// It is the line of the component in which this address is, see DeviceLock. Before open().
  /// [factory]
  void belongs_to(std::string_view address) { lock_.belongs_to(address); }
  /// guard() was called, and the device outlives this process.
  [[nodiscard]] bool is_guarded() const { return guarded_ != nullptr && lasts_; }
  /// For reopen() to open it, also while another process has it: for emergencies. [factory]
  void choose(const std::string& device, int baud, Use use);
  /// Takes the order back from the guardian, and gives the device free.
  void close() override;
  bool reopen() override;
  [[nodiscard]] std::string name() const override { return path_; }
  bool tune() override;
  [[nodiscard]] std::uint8_t times_overruled() const override;
  void repeat_order() override;
  [[nodiscard]] bool is_awaited() const override { return lock_.is_awaited(); }
  /// The device is there.
  [[nodiscard]] bool is_open() const { return device_.open(); }
  [[nodiscard]] int number() const override { return device_.number(); }
  [[nodiscard]] std::ptrdiff_t read(std::span<char> into) override;
  [[nodiscard]] std::ptrdiff_t write(std::string_view bytes) const override;

 private:
  mauve::Status be_guarded();

  Descriptor device_;
  DeviceLock lock_;
  bool alone_ = false;  // the lock is taken at each opening
  std::string path_;
  mauve::Guarded* guarded_ = nullptr;
  std::atomic<const std::atomic<std::uint32_t>*> times_due_{nullptr};  // of `guarded_`
  mauve::SafeOrder order_;
  std::string order_bytes_;
  bool lasts_ = false;  // longer than this process
  int baud_ = 0;
  Use use_ = Use::reading;
  bool terminal_ = false;
};

/// A pseudo-terminal whose other end can be opened as a serial device under a name of our choice.
class PseudoTerminal final : public LineEnd {
 public:
  PseudoTerminal() = default;
  ~PseudoTerminal() override { shut(); }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  /// Creates the pair and, when `name` is not empty, a symbolic link to the device at its
  /// line_path(). A link of this user that leads nowhere, or to a line of this process, is
  /// replaced; anything else there is refused. [factory]
  mauve::Status open(const std::string& name);
  /// Removes the link, too.
  void close() override { shut(); }
  /// False: no other program could find the same terminal again.
  bool reopen() override { return false; }
  /// Path of the device.
  [[nodiscard]] const std::string& device() const { return path_; }
  [[nodiscard]] int number() const override { return master_.number(); }
  [[nodiscard]] std::ptrdiff_t read(std::span<char> into) override;
  [[nodiscard]] std::ptrdiff_t write(std::string_view bytes) const override;
  /// Sends the bytes that fit and returns their number.
  [[nodiscard]] std::size_t send_some(std::string_view bytes) const;
  /// The same; bytes that do not fit are lost, as on a real line without a listener. False: some
  /// were lost.
  bool send(std::string_view bytes) const { return send_some(bytes) == bytes.size(); }
  /// The bytes that the other end wrote, as far as they fit; 0 when there are none.
  [[nodiscard]] std::size_t receive(std::span<char> into) const;

 private:
  void shut();

  Descriptor master_;
  Descriptor slave_;  // kept open: else the pair hangs up whenever the reader closes
  std::string path_;
  std::string link_;
};

}  // namespace mauve::serial
