// SPDX-License-Identifier: LGPL-3.0-or-later
/// The benchmark of the paper, section 4:
///   paper [--smoke] [--out FOLDER] [execution | reconfiguration | exchange]...
/// ROS is measured where there is a master (ROS_MASTER_URI) and the program beside this one.
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include "bench/paper/experiments.h"
#include "bench/support/machine.h"
#include "bench/support/parts.h"
#include "rt/thread/thread.h"

namespace bench::paper {
namespace {

namespace fs = std::filesystem;

const std::map<std::string, void (*)(Book&, const Setting&)>& experiments() {
  static const std::map<std::string, void (*)(Book&, const Setting&)> all{
      {"exchange", measure_exchange},
      {"execution", measure_execution},
      {"reconfiguration", measure_reconfiguration}};
  return all;
}

/// A program beside this one, or empty.
std::string neighbour(const std::string& name) {
  const fs::path path = fs::read_symlink("/proc/self/exe").parent_path() / name;
  return fs::exists(path) ? path.string() : std::string();
}

void run(const Parts& command) {
  Book book(command.folder);
  Setting setting{command.options, mauve::rt::usable_cpus().back(), neighbour("paper_ros"),
                  neighbour("paper_orocos")};
  book.text("## The paper's benchmark");
  book.text(describe_machine());
  if (setting.ros.empty()) {
    book.text("ROS is not measured: roscpp was not found when this was built (scripts/setup).");
  } else if (std::getenv("ROS_MASTER_URI") == nullptr) {
    book.text("ROS is not measured: no master (ROS_MASTER_URI); scripts/bench paper starts one.");
    setting.ros.clear();
  }
  if (setting.orocos.empty()) {
    book.text("Orocos RTT is not measured: it was not found when this was built.");
  }
  for (const std::string& name : command.names) experiments().at(name)(book, setting);
  book.goals();
  book.text("At the end: " + describe_machine());
}

}  // namespace
}  // namespace bench::paper

int main(int argc, char** argv) {
  bench::paper::run(bench::parse_parts(argc, argv, {"execution", "reconfiguration", "exchange"}));
}
