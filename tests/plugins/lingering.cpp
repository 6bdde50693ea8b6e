// SPDX-License-Identifier: LGPL-3.0-or-later
/// Its constructor starts a thread that outlives it, until a file is gone.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "number.h"

namespace {

class Lingering final : public zoo::NumberCore {
 public:
  Lingering() {
    std::thread([file = std::filesystem::path(std::getenv("ZOO_LINGERS"))] {
      while (std::filesystem::exists(file)) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        rounds() += 1;
      }
    }).detach();
  }
  int number() override { return rounds(); }

 private:
  static int& rounds() {
    static int count = 0;
    return count;
  }
};

}  // namespace

MAUVE_PLUGIN(plugin) { plugin.core<Lingering>("number"); }
