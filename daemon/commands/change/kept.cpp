// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/text/value_json.h"

#include "base/thread_role.h"
#include "commands/change/change.h"
#include "commands/model.h"
#include "commands/say.h"
#include "mauve/property.h"

namespace mauve::daemon {

namespace {

/// Appends the fields of `now` that `given` does not name: {"address","value"}.
void add_kept(const std::string& address, const Value& given, const Value& now, Json& kept) {
  const auto* members = now.get_if<Value::Object>();
  if (members == nullptr || given.get_if<Value::Object>() == nullptr) {
    return;
  }
  for (const auto& [name, value] : *members) {
    const auto field = address + "." + name;
    if (const auto* same = given.find(name); same != nullptr) {
      add_kept(field, *same, value, kept);
    } else {
      kept.push_back({{"address", field}, {"value", arch::to_json(value)}});
    }
  }
}

}  // namespace

void say_kept(const Running& running, const Change& change, Json& result) {
  MAUVE_ON_THREAD(control);
  auto kept = Json::array();
  for (const auto& edit : change.edits) {
    for (const auto& [path, given] : edit.properties) {
      const auto address = edit.member + "." + path;
      const auto target = find_target(running, address);
      if (target && target->property != nullptr) {
        add_kept(address, given, target->property->value(), kept);
      }
    }
  }
  if (!kept.empty()) {
    result["kept"] = std::move(kept);
  }
}

}  // namespace mauve::daemon
