// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/parse/parse.h"

#include <algorithm>
#include <string>
#include <utility>

#include "arch/parse/built_in.h"
#include "arch/parse/parse_element.h"
#include "arch/parse/parse_rules.h"
#include "arch/parse/parse_task.h"
#include "arch/text/json.h"
#include "arch/text/read.h"
#include "base/address.h"
#include "base/duration.h"
#include "mauve/detail/resource_lock.h"

namespace mauve::arch {
namespace {

// "velocity/1" of a plugin, or "double" and the like.
bool is_data_name(std::string_view text) { return is_revised_name(text) || is_name(text); }

std::optional<Duration> read_lock_budget(const Source& source) {
  const auto hold = read_positive(source);
  if (!hold || *hold <= kLongestBudget) return hold;
  source.refuse(
      "is longer than callers wait for a resource",
      "declare the longest time that one call takes, at most " + format_duration(kLongestBudget));
  return std::nullopt;
}

void refuse_meaningless_lock_budget(const Source& source, const ResourceSpec& resource) {
  if (!resource.lock_budget || resource.type.value != kSharedData) return;
  source.problems.add(
      resource.lock_budget->where, {Errc::invalid_value, "file_key_without_meaning"},
      resource.name + ".lock_budget",
      "has no meaning here: shared_data is held for some stores only", "remove this key");
}

void read_resource(const Source& source, ResourceSpec& resource) {
  const auto data = [](const Source& value) -> std::optional<std::string> {
    auto name = read_name(value, is_data_name, "write name and revision, such as \"velocity/1\"");
    if (!name) return std::nullopt;
    return name->value;
  };
  read_object(source, {type_field(resource),
                       {"data", placed(resource.data, data)},
                       properties_field(resource, {"shell", "core", "interface"}),
                       ports_field(resource),
                       {"lock_budget", placed(resource.lock_budget, read_lock_budget)},
                       {"cross_core", [&](const Source& value) {
                          resource.cross_core = read_flag(value).value_or(false);
                        }}});
  require_type(source, resource);
  refuse_meaningless_lock_budget(source, resource);
}

// A policy that leads to the fallback core needs one.
void require_fallback(const Source& source, const ComponentSpec& component) {
  if (component.fallback) return;
  const auto refuse = [&](const char* key, Position where) {
    source.problems.add(where, {Errc::invalid_value, "fallback_core_missing"},
                        component.name + ".task." + key, "\"fallback\" needs a fallback core",
                        "write \"fallback_core\": \"plugin/name\" beside \"task\"");
  };
  const TaskSpec& task = component.task;
  if (task.on_overrun && task.on_overrun->value == OnOverrun::fallback) {
    refuse("on_overrun", task.on_overrun->where);
  }
  if (task.on_fault && task.on_fault->value.action == FaultPolicy::Action::fallback) {
    refuse("on_fault", task.on_fault->where);
  }
}

void read_component(const Source& source, ComponentSpec& component) {
  read_object(
      source,
      {type_field(component),
       type_name_field("core", component.core),
       type_name_field("fsm", component.fsm),
       fallback_field(component.fallback),
       properties_field(component, {"shell", "core", "fsm"}),
       ports_field(component),
       {"task", [&](const Source& value) { read_task(value, component.task); }},
       {"start", [&](const Source& value) { component.start = read_flag(value).value_or(true); }},
       {"may_request",
        [&](const Source& value) { read_may_request(value, component.may_request); }}});
  require_type(source, component);
  require_fallback(source, component);
}

template <typename Element>
auto read_elements(std::vector<Element>& into, void (*read)(const Source&, Element&)) {
  return [&into, read](const Source& source) {
    read_members(source, [&](const Member& member, const Source& value) {
      const Source element{value.node, member.key, value.problems};
      if (!good_key(member, element)) return;
      Element spec;
      spec.name = member.key;
      spec.where = member.where;
      read(element, spec);
      into.push_back(std::move(spec));
    });
  };
}

void read_plugins(const Source& source, std::vector<PlacedText>& plugins) {
  read_items(source, [&](const Source& item) {
    const auto name = read_name(item, is_name, "plugins are named, without path or \".so\"");
    if (!name) return;
    const auto same = std::find_if(plugins.begin(), plugins.end(), [&](const PlacedText& plugin) {
      return plugin.value == name->value;
    });
    if (same != plugins.end()) {
      return item.refuse("\"" + name->value + "\" appears twice", {},
                         {Errc::duplicate, "file_says_twice"});
    }
    plugins.push_back(*name);
  });
}

void read_lost(const Source& source, std::vector<PlacedText>& lost) {
  read_items(source, [&](const Source& item) {
    if (auto text = read_text(item)) lost.push_back({*std::move(text), item.node.where});
  });
}

bool names(const TransactionSpec& transaction, const std::string& lost) {
  return std::ranges::any_of(transaction.steps, [&](const StepSpec& one) {
    return one.step.subject == lost || one.step.object == lost;
  });
}

bool names(const std::optional<ConditionSpec>& condition, const std::string& lost) {
  return condition && std::ranges::any_of(condition->value.comparisons(),
                                          [&](const auto& one) { return one.address == lost; });
}

// Such an entry would permit a slip of the pen later.
void refuse_unnamed_lost(const Source& source, const Spec& spec) {
  for (const PlacedText& lost : spec.lost) {
    const bool named =
        std::ranges::any_of(spec.transactions,
                            [&](const auto& one) { return names(one, lost.value); }) ||
        std::ranges::any_of(spec.rules, [&](const RuleSpec& rule) {
          return names(rule.when, lost.value) || names(rule.until, lost.value) ||
                 names(rule.steps, lost.value);
        });
    if (named) continue;
    source.problems.add(lost.where, {Errc::invalid_value, "file_key_without_meaning"}, "lost",
                        "no rule and no transaction names \"" + lost.value + "\"",
                        "remove this entry");
  }
}

void read_schema(const Source& source) {
  const auto text = read_text(source);
  if (text && *text != kSchema) {
    source.refuse("this version of mauve reads \"" + std::string(kSchema) + "\" only", {},
                  {Errc::unsupported, "file_not_supported"});
  }
}

// Components and resources share one space of names.
void refuse_shared_names(const Spec& spec, Problems& problems) {
  for (const ComponentSpec& component : spec.components) {
    const auto same =
        std::find_if(spec.resources.begin(), spec.resources.end(),
                     [&](const ResourceSpec& resource) { return resource.name == component.name; });
    if (same == spec.resources.end()) continue;
    problems.add(component.where, {Errc::duplicate, "file_says_twice"}, component.name,
                 "a resource has this name already",
                 "it is in line " + std::to_string(same->where.line));
  }
}

}  // namespace

std::optional<Spec> parse(std::string_view text, Problems& problems) {
  const std::optional<Node> node = parse_json(text, problems);
  if (!node) return std::nullopt;
  const Source root{*node, "", problems};
  Spec spec;
  const Node::Object* members = read_object(
      root,
      {{"$schema", [](const Source& value) { static_cast<void>(read_text(value)); }},
       {"schema", read_schema},
       {"name",
        [&](const Source& value) {
          if (auto name = read_name(value, is_name, "a name such as \"rover\"")) {
            spec.name = name->value;
          }
        }},
       {"plugins", [&](const Source& value) { read_plugins(value, spec.plugins); }},
       {"resources", read_elements(spec.resources, read_resource)},
       {"components", read_elements(spec.components, read_component)},
       {"transactions", [&](const Source& value) { read_transactions(value, spec.transactions); }},
       {"rules", [&](const Source& value) { read_rules(value, spec.rules); }},
       {"lost", [&](const Source& value) { read_lost(value, spec.lost); }}});
  refuse_unnamed_lost(root, spec);
  if (members == nullptr) return std::nullopt;
  require_key(root, *members, "schema", "\"schema\": \"mauve/architecture/1\"");
  require_key(root, *members, "name", "\"name\": \"rover\"");
  refuse_shared_names(spec, problems);
  return spec;
}

}  // namespace mauve::arch
