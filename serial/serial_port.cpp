// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/serial/serial_port.h>

#include <fcntl.h>
#include <stdlib.h>  // NOLINT: posix_openpt and its family
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

namespace mauve::serial {
namespace {

namespace fs = std::filesystem;
using mauve::Errc;
using mauve::refuse;
using mauve::Status;

std::string system_text(int number) { return std::generic_category().message(number); }

speed_t speed_of(int baud) {
  constexpr std::array<std::pair<int, speed_t>, 9> kSpeeds{{{4800, B4800},
                                                            {9600, B9600},
                                                            {19200, B19200},
                                                            {38400, B38400},
                                                            {57600, B57600},
                                                            {115200, B115200},
                                                            {230400, B230400},
                                                            {460800, B460800},
                                                            {921600, B921600}}};
  for (const auto& [number, speed] : kSpeeds) {
    if (number == baud) return speed;
  }
  return B0;
}

/// False with errno set. A file or a FIFO, which is no terminal, needs no settings. A change of
/// them waits for all who use the terminal, so nothing is set that is there already.
bool set_raw(int descriptor, int baud) {
  termios before{};
  if (tcgetattr(descriptor, &before) != 0) return true;
  termios settings = before;
  cfmakeraw(&settings);
  settings.c_cflag |= static_cast<tcflag_t>(CLOCAL | CREAD);
  if (baud != 0) {
    cfsetispeed(&settings, speed_of(baud));
    cfsetospeed(&settings, speed_of(baud));
  }
  const bool same = std::memcmp(&settings, &before, sizeof settings) == 0;
  return same || tcsetattr(descriptor, TCSANOW, &settings) == 0;
}

Status check_speed(int baud) {
  if (baud == 0 || speed_of(baud) != B0) return mauve::ok();
  return refuse(Errc::invalid_value, {}, "no such speed: " + std::to_string(baud) + " baud",
                "common ones are 9600, 38400 and 115200; 0 leaves it alone");
}

Status make_raw(int descriptor, int baud) {
  if (!set_raw(descriptor, baud)) {
    return refuse(Errc::system, {}, "cannot set the line to raw mode: " + system_text(errno));
  }
  return mauve::ok();
}

int open_quietly(const std::string& path, SerialPort::Use use) {
  const int way = use == SerialPort::Use::both ? O_RDWR : O_RDONLY;
  return ::open(path.c_str(), way | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
}

std::ptrdiff_t write_some(int descriptor, std::string_view bytes) {
  const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
  if (count >= 0) return count;
  return errno == EAGAIN || errno == EINTR ? 0 : -1;
}

/// Unplugged, or not plugged in yet: it may come.
bool absent(int error) {
  return error == ENOENT || error == ENODEV || error == ENXIO || error == EIO;
}

/// Does this process hold the device?
bool is_ours(const fs::path& device) {
  std::error_code ignored;
  for (const auto& open : fs::directory_iterator("/proc/self/fd", ignored)) {
    if (fs::read_symlink(open.path(), ignored) == device) return true;
  }
  return false;
}

/// A link of this user that leads nowhere, or to a line that this process made before, may go.
Status check_place(const std::string& link) {
  std::error_code ignored;
  const fs::file_status there = fs::symlink_status(link, ignored);
  if (!fs::exists(there)) return mauve::ok();
  if (!fs::is_symlink(there)) {
    return refuse(Errc::conflict, {}, "'" + link + "' is there and is not a symbolic link",
                  "choose another path");
  }
  struct stat facts {};
  if (::lstat(link.c_str(), &facts) == 0 && facts.st_uid != ::geteuid()) {
    return refuse(Errc::conflict, {},
                  "'" + link + "' is there and belongs to user " + std::to_string(facts.st_uid),
                  "remove it, or choose another path");
  }
  const fs::path device = fs::read_symlink(link, ignored);
  if (!fs::exists(link, ignored) || is_ours(device)) return mauve::ok();
  return refuse(Errc::conflict, {},
                "'" + link + "' is in use: it leads to " + device.string() + ", which is there",
                "is another one running? \"pty:NAME\" is a name of each mauved's own");
}

/// Its number and the tick in which it began: the link of a process that was killed is never
/// mistaken for one of a later process that got its number. Empty: there is no such process.
std::string name_of_process(pid_t process) {
  constexpr int kBegan = 22;  // field of /proc/PID/stat, see proc(5)
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  if (!std::getline(file, text)) return {};
  std::istringstream after_name(text.substr(text.rfind(')') + 1));
  std::string field;
  for (int number = 3; number <= kBegan; ++number) after_name >> field;
  return std::to_string(process) + "-" + field;
}

constexpr std::string_view kLinkBegin = "mauve-";

/// Of processes of this user that were killed: "mauve-NAME.PROCESS", beside a link of this process.
void remove_stale_links(const fs::path& link) {
  if (!link.filename().string().ends_with("." + name_of_process(::getpid()))) return;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(link.parent_path(), ignored)) {
    const std::string name = entry.path().filename();
    const std::string process = name.substr(name.rfind('.') + 1);
    const int number = std::atoi(process.c_str());
    const bool ours =
        name.starts_with(kLinkBegin) && number > 0 && process.find('-') < process.size();
    struct stat facts {};
    if (!ours || ::lstat(entry.path().c_str(), &facts) != 0 || !S_ISLNK(facts.st_mode) ||
        facts.st_uid != ::geteuid() || name_of_process(number) == process) {
      continue;
    }
    fs::remove(entry.path(), ignored);
  }
}

Status replace_link(const std::string& target, const std::string& link) {
  if (Status ready = check_place(link); !ready) return ready;
  remove_stale_links(link);
  std::error_code problem;
  fs::remove(link, problem);
  fs::create_symlink(target, link, problem);
  if (problem) {
    return refuse(Errc::system, {}, "cannot create the link '" + link + "': " + problem.message());
  }
  return mauve::ok();
}

}  // namespace

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  std::swap(number_, other.number_);
  return *this;
}

Descriptor::~Descriptor() {
  if (number_ >= 0) ::close(number_);
}

std::string line_path(const std::string& name) {
  constexpr std::string_view kOwn = "pty:";
  if (name.rfind(kOwn, 0) != 0) return name;
  std::string place = "/tmp";
  for (const char* variable : {"RUNTIME_DIRECTORY", "XDG_RUNTIME_DIR"}) {
    const char* const said = std::getenv(variable);
    if (said == nullptr || ::access(said, W_OK) != 0) continue;
    place = said;
    break;
  }
  return place + "/" + std::string(kLinkBegin) + name.substr(kOwn.size()) + "." +
         name_of_process(::getpid());
}

void SerialPort::choose(const std::string& device, int baud, Use use) {
  close();
  alone_ = false;
  path_ = line_path(device);
  lasts_ = path_ == device;
  baud_ = baud;
  use_ = use;
}

Status SerialPort::open(const std::string& device, int baud, Missing missing, Use use) {
  if (Status speed = check_speed(baud); !speed) return speed;
  const std::string path = line_path(device);
  Descriptor opened(open_quietly(path, use));
  const int why = opened.open() ? 0 : errno;
  if (missing == Missing::accepted && absent(why)) {
    choose(device, baud, use);
    alone_ = true;
    return mauve::ok();
  }
  if (!opened.open()) {
    return refuse(Errc::system, {}, "cannot open '" + path + "': " + system_text(why),
                  why == EACCES ? "the user of mauved needs the group 'dialout'"
                                : "is the receiver plugged in, and the path right? A relative one "
                                  "begins where mauved was started");
  }
  const bool terminal = ::isatty(opened.number()) == 1;
  if (use == Use::both && !terminal) {
    return refuse(Errc::invalid_value, {}, "'" + device + "' is no serial device",
                  "requests would be written into it; name one such as /dev/ttyACM0");
  }
  choose(device, baud, use);
  alone_ = true;
  // Before any setting, which would reach the device of the one that has the lock.
  using Found = DeviceLock::Found;
  const Found found = terminal
                          ? lock_.take(opened.number(), path_.c_str(), DeviceLock::Opening::first)
                          : Found::free;
  if (found == Found::other_component && missing == Missing::accepted) return mauve::ok();
  if (found == Found::other_component) {
    return refuse(Errc::conflict, {}, "'" + path_ + "' is the device of another component",
                  "one device has one driver: stop that one, or name another device");
  }
  if (found == Found::unknown) {
    return refuse(Errc::system, {}, "cannot lock '" + path_ + "': " + system_text(errno),
                  "without the lock another process could drive the same device");
  }
  if (found == Found::other_process) {
    return refuse(Errc::conflict, {}, "'" + path_ + "' belongs to " + holder_of(path_),
                  "one device has one driver: end that process, or name another device");
  }
  if (Status raw = make_raw(opened.number(), 0); !raw) {
    lock_.release();
    return raw;
  }
  device_ = std::move(opened);
  terminal_ = terminal;
  return be_guarded();
}

void SerialPort::guard(mauve::Guarded& guarded, const mauve::SafeOrder& order) {
  guarded_ = &guarded;
  order_bytes_ = order.bytes;
  order_ = order;
  order_.bytes = order_bytes_;
}

Status SerialPort::be_guarded() {
  if (!is_guarded()) return mauve::ok();
  Status held = guarded_->hold(device_.number(), order_);
  times_due_ = guarded_->times_due();
  return held;
}

std::uint8_t SerialPort::times_overruled() const {
  const auto* const times = times_due_.load();
  return times == nullptr ? 0 : static_cast<std::uint8_t>(times->load());
}

void SerialPort::repeat_order() {
  if (is_guarded()) guarded_->repeat();
}

void SerialPort::close() {
  if (guarded_ != nullptr) guarded_->drop();
  device_ = Descriptor();
  lock_.release();
}

bool SerialPort::reopen() {
  lock_.release();  // a line that waits must not keep the number of a device that is gone
  Descriptor opened(open_quietly(path_, use_));
  if (!opened.open()) return false;
  const bool terminal = ::isatty(opened.number()) == 1;
  if (use_ == Use::both && !terminal) return false;
  if (alone_ && terminal) {
    using Found = DeviceLock::Found;
    const Found found = lock_.take(opened.number(), path_.c_str(), DeviceLock::Opening::again);
    if (found == Found::other_process) errno = EBUSY;
    if (found == Found::other_component) errno = kOfAnotherComponent;
    if (found != Found::free) return false;
  }
  // A line that has the device already gave it its speed.
  if (!set_raw(opened.number(), lock_.is_shared() ? 0 : baud_)) return false;
  terminal_ = terminal;
  device_ = std::move(opened);
  if (be_guarded()) return true;
  close();
  errno = kNotGuarded;
  return false;
}

bool SerialPort::tune() {
  return terminal_ && baud_ != 0 && is_open() && set_raw(device_.number(), baud_);
}

std::ptrdiff_t SerialPort::read(std::span<char> into) {
  const ssize_t count = ::read(device_.number(), into.data(), into.size());
  if (count == 0 && terminal_) return -1;  // a raw terminal has no end: it hung up
  if (count >= 0) return count;
  return errno == EAGAIN || errno == EINTR ? 0 : -1;
}

std::ptrdiff_t SerialPort::write(std::string_view bytes) const {
  return write_some(device_.number(), bytes);
}

Status PseudoTerminal::open(const std::string& name) {
  const std::string link = line_path(name);
  Descriptor master(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  std::array<char, 128> path{};
  if (!master.open() || grantpt(master.number()) != 0 || unlockpt(master.number()) != 0 ||
      ptsname_r(master.number(), path.data(), path.size()) != 0) {
    return refuse(Errc::system, {}, "cannot create a pseudo-terminal: " + system_text(errno));
  }
  Descriptor slave(::open(path.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (!slave.open()) {
    return refuse(Errc::system, {},
                  "cannot open '" + std::string(path.data()) + "': " + system_text(errno));
  }
  if (Status raw = make_raw(slave.number(), 0); !raw) return raw;
  if (!link.empty()) {
    if (Status linked = replace_link(path.data(), link); !linked) return linked;
  }
  shut();
  master_ = std::move(master);
  slave_ = std::move(slave);
  path_ = path.data();
  link_ = link;
  return mauve::ok();
}

void PseudoTerminal::shut() {
  std::error_code ignored;
  // Only our own link: a successor may have put its own there meanwhile.
  if (!link_.empty() && fs::read_symlink(link_, ignored) == path_) {
    fs::remove(link_, ignored);
  }
  link_.clear();
  path_.clear();
  master_ = Descriptor();
  slave_ = Descriptor();
}

/// We hold the device ourselves: it never fails.
std::ptrdiff_t PseudoTerminal::read(std::span<char> into) {
  return static_cast<std::ptrdiff_t>(receive(into));
}

std::ptrdiff_t PseudoTerminal::write(std::string_view bytes) const {
  return static_cast<std::ptrdiff_t>(send_some(bytes));
}

std::size_t PseudoTerminal::send_some(std::string_view bytes) const {
  const ssize_t count = ::write(master_.number(), bytes.data(), bytes.size());
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

std::size_t PseudoTerminal::receive(std::span<char> into) const {
  const ssize_t count = ::read(master_.number(), into.data(), into.size());
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

}  // namespace mauve::serial
