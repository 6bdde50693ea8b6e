// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/parse/transaction.h"

#include <algorithm>
#include <string>
#include <utility>

#include "arch/parse/target.h"
#include "mauve/host/architecture.h"
#include "mauve/host/deployer.h"
#include "plugin/load/catalog.h"

namespace mauve::arch {
namespace {

using rules::Action;
using rules::Step;

class Merger {
 public:
  Merger(const Architecture& architecture, const Deployer& deployer, const plugin::Catalog& catalog)
      : architecture_(architecture), deployer_(deployer), catalog_(catalog) {}

  Status add(const Step& step) {
    switch (step.action) {
      case Action::disconnect:
      case Action::connect:
        return add_connection(step);
      case Action::swap:
        return add_swap(step);
      case Action::set:
        return add_property(step);
      case Action::stop:
      case Action::start:
        return add_mode(step);
    }
    return ok();
  }

  Change take() { return std::move(change_); }

 private:
  Edit& edit_of(const Step& step) {
    const auto name = rules::element_of(step);
    const auto found = std::find_if(change_.edits.begin(), change_.edits.end(),
                                    [&](const Edit& edit) { return edit.member == name; });
    if (found != change_.edits.end()) return *found;
    change_.edits.emplace_back().member = name;
    return change_.edits.back();
  }

  Status add_connection(const Step& step) {
    const auto target = find_target(architecture_, step.subject);
    if (!target) return target.error();
    const Binding* const present = connection(target->element, *target->port);
    const bool connects = step.action == Action::connect;
    const bool so_already =
        connects ? present != nullptr && is_wanted(*present, step) : present == nullptr;
    if (so_already) return ok();
    const std::string port(target->port->name());
    Edit& edit = edit_of(step);
    const auto known = std::find(edit.disconnect.begin(), edit.disconnect.end(), port);
    if (present != nullptr && known == edit.disconnect.end()) edit.disconnect.push_back(port);
    if (connects) edit.connect.push_back({port, step.object, step.max_age});
    return ok();
  }

  static bool is_wanted(const Binding& present, const Step& step) {
    return present.service().address() == step.object && present.max_age() == step.max_age;
  }

  Status add_swap(const Step& step) {
    const auto component = find_component(architecture_, step.subject);
    if (!component) return component.error();
    const bool in_force = (*component)->bundle()->core_type.name == step.object;
    if (in_force && !step.fresh) return ok();
    auto core = catalog_.core(step.object);
    if (!core) return core.error();
    Edit& edit = edit_of(step);
    edit.core = *std::move(core);
    edit.state = step.fresh ? StatePolicy::drop : StatePolicy::offer;
    edit.values = Values::fit;  // a reaction is not refused for a value
    return ok();
  }

  Status add_property(const Step& step) {
    const auto target = find_target(architecture_, step.subject);
    const bool same =
        target && target->property != nullptr && target->property->value() == step.value;
    const auto name = rules::element_of(step);
    const bool swapped =
        std::any_of(change_.edits.begin(), change_.edits.end(),
                    [&](const Edit& edit) { return edit.member == name && edit.core.has_value(); });
    if (same && !swapped) return ok();
    edit_of(step).properties.emplace_back(step.subject.substr(name.size() + 1), step.value);
    return ok();
  }

  Status add_mode(const Step& step) {
    if (const auto component = find_component(architecture_, step.subject); !component) {
      return component.error();
    }
    // One that is faulted or recovers is neither stopped nor does it run: either step is to be
    // done.
    const ComponentState state = deployer_.status(step.subject).state;
    const bool runs = state == ComponentState::running;
    const bool stands = state == ComponentState::stopped;
    const bool wanted = step.action == Action::start;
    if (wanted ? !runs : !stands) edit_of(step).mode = wanted ? Mode::run : Mode::park;
    return ok();
  }

  const Architecture& architecture_;
  const Deployer& deployer_;
  const plugin::Catalog& catalog_;
  Change change_;
};

}  // namespace

Result<Change> change_of(const rules::Steps& steps, const Architecture& architecture,
                         const Deployer& deployer, const plugin::Catalog& catalog) {
  Merger merger(architecture, deployer, catalog);
  // Swaps first: whether a property is to be set depends on them.
  for (const bool swaps : {true, false}) {
    for (const Step& step : steps) {
      if ((step.action == Action::swap) != swaps) continue;
      if (Status done = merger.add(step); !done) return done.error();
    }
  }
  return merger.take();
}

}  // namespace mauve::arch
