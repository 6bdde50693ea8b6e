// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/component/devices.h"

#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <string_view>
#include <system_error>

#include <mauve/core.h>
#include <mauve/detail/property_base.h>
#include <mauve/host/value.h>
#include <mauve/shell.h>

namespace mauve {
namespace {

/// Any number of drivers share these: /dev/null and its like, joysticks, the chips on an I2C bus,
/// the lines of a GPIO chip. The last have no major number of their own.
constexpr std::array<unsigned, 3> kSharedMajors{1, 13, 89};
constexpr std::array<std::string_view, 3> kSharedNames{"/dev/input/", "/dev/i2c-", "/dev/gpiochip"};

bool names_device(const PropertyBase* property) {
  return property->within().find("/dev/") != std::string_view::npos;
}

/// Equal for two paths of one device; empty: any number of drivers may share it.
std::string identity_of(const std::string& path) {
  if (path.starts_with("pty:")) return path;  // the name of a simulated one
  std::error_code failed;
  const auto from = std::filesystem::absolute(path, failed);
  const auto place = std::filesystem::weakly_canonical(from, failed);
  const std::string text = failed ? path : place.string();
  const auto begins = [&text](std::string_view name) { return text.starts_with(name); };
  if (std::ranges::any_of(kSharedNames, begins)) return "";
  struct stat file {};
  if (stat(path.c_str(), &file) != 0 || !S_ISCHR(file.st_mode)) return text;
  const unsigned kind = major(file.st_rdev);
  if (std::ranges::find(kSharedMajors, kind) != kSharedMajors.end()) return "";
  return std::to_string(kind) + ":" + std::to_string(minor(file.st_rdev));
}

}  // namespace

const PropertyBase* device_of(const CoreBase& core) {
  const auto& all = core.properties();
  const auto found = std::find_if(all.begin(), all.end(), names_device);
  return found == all.end() ? nullptr : *found;
}

void Devices::put(const std::string& component, const Shell& shell, const CoreBase& core,
                  bool is_new) {
  std::set<std::string> before;
  for (const auto& [address, one] : opened_) {
    if (one.component == component) before.insert(one.path);
  }
  remove(component);
  for (const Configurable* const part :
       {static_cast<const Configurable*>(&shell), static_cast<const Configurable*>(&core)}) {
    for (const PropertyBase* const property : part->properties()) {
      if (!names_device(property)) continue;
      const Value value = property->value();
      const auto* const path = value.get_if<std::string>();
      if (path == nullptr || path->empty()) continue;
      opened_[property->address()] = {component, *path, is_new && !before.contains(*path)};
    }
  }
}

void Devices::remove(const std::string& component) {
  std::erase_if(opened_,
                [&component](const auto& entry) { return entry.second.component == component; });
}

std::vector<Error> Devices::errors() const {
  std::vector<Error> errors;
  for (const auto& entry : opened_) {
    const Opened& one = entry.second;
    if (!one.is_new) continue;
    const std::string identity = identity_of(one.path);
    if (identity.empty()) continue;
    const auto other = std::ranges::find_if(opened_, [&](const auto& its) {
      const bool comes_later = its.second.is_new && its.first >= entry.first;  // the second one
      return its.second.component != one.component && !comes_later &&
             identity_of(its.second.path) == identity;
    });
    if (other == opened_.end()) continue;
    const std::string as = other->second.path == one.path ? "" : " as " + other->second.path;
    errors.push_back(
        refuse({Errc::conflict, "device_has_driver"}, entry.first,
               one.path + " is the device of " + other->first + as +
                   " already: of two drivers each overrules the other, or takes its bytes",
               "name the device of this driver, or remove the other one in the same change"));
  }
  return errors;
}

std::vector<std::pair<std::string, std::string>> Devices::notes() const {
  std::vector<std::pair<std::string, std::string>> notes;
  std::map<std::string, std::string> first;  // address by identity
  for (const auto& [address, one] : opened_) {
    const std::string identity = identity_of(one.path);
    const auto [other, alone] = first.emplace(identity, address);
    const bool own = opened_.at(other->second).component == one.component;
    if (alone || own || identity.empty()) continue;
    notes.emplace_back(address, "names " + one.path + ", which has become the device of " +
                                    other->second +
                                    " too: each of these drivers overrules the other, or takes "
                                    "its bytes; stop one of them");
  }
  return notes;
}

}  // namespace mauve
