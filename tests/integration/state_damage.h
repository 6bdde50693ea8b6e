// SPDX-License-Identifier: LGPL-3.0-or-later
/// Damage to a state directory, of a kind and at a place that a seed decides.
#pragma once

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "support/temp_dir.h"

namespace mauve::test {

class StateDamage {
 public:
  StateDamage(std::filesystem::path state, std::filesystem::path elsewhere, std::uint64_t seed)
      : state_(std::move(state)), elsewhere_(std::move(elsewhere)), random_(seed) {}

  /// Does it, and says what it did.
  std::string next() {
    switch (below(12)) {
      case 0:
        return whole_folder();
      case 1:
        return stray_file();
      case 2:
        return in_the_way();
      case 3:
        return of_a_directory();
      default:
        return of_a_file(some_file());
    }
  }

 private:
  using path = std::filesystem::path;

  std::size_t below(std::size_t limit) { return random_() % limit; }

  /// Generations twice as often as everything else.
  path some_file() {
    std::vector<path> files;
    std::error_code gone;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(state_, gone)) {
      if (std::filesystem::is_directory(entry.symlink_status())) continue;
      files.push_back(entry.path());
      if (entry.path().parent_path() != state_) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files.empty() ? state_ / "running" : files[below(files.size())];
  }

  std::string of_a_file(const path& file) {
    const auto content = content_of(file);
    const auto name = file.filename().string();
    switch (below(12)) {
      case 0:
        truncate(file, below(content.size() + 1));
        return name + " cut";
      case 1:
        write(file, std::string(content.size(), '\0'));
        return name + " zeroed";
      case 2:
      case 3:
        return flip(file, content);
      case 4:
        std::filesystem::remove(file);
        return name + " removed";
      case 5:
        replace(file);
        std::filesystem::create_directories(below(2) == 0 ? file : file / "inner");
        return name + " is a directory";
      case 6:
        link(file, content);
        return name + " is a symbolic link";
      case 7:
        replace(file);
        static_cast<void>(mkfifo(file.c_str(), 0640));
        return name + " is a FIFO";
      case 8:
        write(file, content_of(some_file()));
        return name + " has the content of another file";
      case 9:
        chmod(file.c_str(), 0666);
        return name + " may be written by everybody";
      case 10:
        return own(file);
      default:
        truncate(file, std::uintmax_t{1} << 32);
        return name + " is huge";
    }
  }
  std::string flip(const path& file, std::string content) {
    if (content.empty()) return "nothing";
    const auto at = below(content.size());
    content[at] = static_cast<char>(content[at] ^ (1 << below(8)));
    write(file, content);
    return file.filename().string() + " with a bit flipped at " + std::to_string(at);
  }
  void link(const path& file, const std::string& content) {
    const auto target = elsewhere_ / (std::to_string(++links_) + ".target");
    if (below(2) == 0) std::ofstream(target, std::ios::binary) << content;
    replace(file);
    std::filesystem::create_symlink(target, file);
  }
  std::string own(const path& file) {
    const bool done = lchown(file.c_str(), 12345, 12345) == 0;
    return done ? file.filename().string() + " belongs to somebody else" : "nothing";
  }

  std::string whole_folder() {
    const auto folder = state_ / "generations";
    if (below(3) == 0) std::filesystem::create_directories(state_ / "generations.damaged" / "old");
    if (!std::filesystem::exists(folder)) return "nothing";
    std::filesystem::remove_all(folder);
    switch (below(4)) {
      case 0:
        std::ofstream(folder) << "no folder";
        return "generations is a file";
      case 1:
        static_cast<void>(mkfifo(folder.c_str(), 0640));
        return "generations is a FIFO";
      case 2:
        std::filesystem::create_symlink(elsewhere_ / "nowhere", folder);
        return "generations is a dangling link";
      default:
        return "generations is gone";
    }
  }
  std::string stray_file() {
    const std::vector<std::string> names{"18446744073709551615.json", "5.json",  "0000007.json",
                                         "000004.json.bak",           "-1.json", "x.json",
                                         "000003.json.new",           "0.json",  ".json",
                                         "999999999999999999999.json"};
    const auto& name = names[below(names.size())];
    std::error_code there;
    std::filesystem::create_directories(state_ / "generations", there);
    if (!there) write(state_ / "generations" / name, below(2) == 0 ? "" : content_of(some_file()));
    return "a stray " + name;
  }
  /// Where mauved makes files.
  std::string in_the_way() {
    const std::vector<std::string> names{"running.new", "quarantine.json.new", "audit.log.1",
                                         "flight-0000-odd.mtrace", "generations.damaged"};
    const auto& name = names[below(names.size())];
    std::error_code there;
    std::filesystem::create_directories(state_ / name / "inner", there);
    return "a directory " + name;
  }
  std::string of_a_directory() {
    const auto directory = below(2) == 0 ? state_ : state_ / "generations";
    const auto name = directory.filename().string();
    if (!std::filesystem::is_directory(directory)) return "nothing";
    if (below(2) == 0) {
      chmod(directory.c_str(), 0777);
      return name + " may be written by everybody";
    }
    return own(directory);
  }

  /// A FIFO would keep its reader.
  static std::string content_of(const path& file) {
    std::error_code gone;
    const bool plain =
        std::filesystem::is_regular_file(std::filesystem::symlink_status(file, gone));
    return plain ? TempDir::read(file) : "";
  }
  static void replace(const path& file) { std::filesystem::remove_all(file); }
  static void write(const path& file, const std::string& content) {
    std::error_code gone;
    if (std::filesystem::is_regular_file(std::filesystem::symlink_status(file, gone)) ||
        !std::filesystem::exists(std::filesystem::symlink_status(file, gone))) {
      std::ofstream(file, std::ios::binary) << content;
    }
  }
  static void truncate(const path& file, std::uintmax_t size) {
    std::error_code failed;
    if (std::filesystem::is_regular_file(std::filesystem::symlink_status(file, failed))) {
      std::filesystem::resize_file(file, size, failed);
    }
  }

  const path state_;
  const path elsewhere_;
  std::mt19937_64 random_;
  int links_ = 0;
};

}  // namespace mauve::test
