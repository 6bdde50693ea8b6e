// SPDX-License-Identifier: LGPL-3.0-or-later
#include "kept_robot.h"

namespace mauve::test {

Step Robot::next() {
  if (lock_ != "none" && below(2) == 0) return lock("none");
  switch (below(15)) {
    case 0:
      return lock(below(2) == 0 ? "params" : "all");
    case 1:
    case 2:
      return {"change.confirm", Json::object(), [](Json&) {}, Step::Kind::confirm};
    case 3:
    case 4:
      return {"change.undo", Json::object(), [](Json&) {}, Step::Kind::undo};
    case 5:
    case 6:
      return stop_or_start();
    case 7:
      return reload();
    case 8:
      return apply();
    case 9:
      return roll_back();
    case 10:
      return quarantined_ ? Step{"quarantine.release", {{"core", kFailing}}}
                          : Step{"core.swap", {{"component", "first"}, {"core", kFailing}}};
    case 11:
      return swap();
    case 12:
      return {"log.set_level", {{"level", below(2) == 0 ? "info" : "warning"}}};
    default:
      return set();
  }
}

void Robot::take(const Step& step, bool kill) {
  if (step.method == "plugin.reload") daemon_.install(build_ = 3 - build_);
  const auto answer = client_.ask(step.method, step.params);
  if (kill) daemon_.process().signal(SIGKILL);
  ASSERT_TRUE(answer.is_object()) << step.method << daemon_.errors();
  story_ += "\n  " + step.method + " " + step.params.dump().substr(0, 100) + " -> " +
            answer.dump().substr(0, 400);
  if (answer.contains("error")) return;
  ++applied_[step.method];
  account(step, answer["result"]);
  if (kill) return static_cast<void>(daemon_.process().wait());
  if (!may_be_last(step)) wait_for_quarantine(answer["result"]);
  const auto exported = client_.ask("config.get")["result"]["architecture"];
  EXPECT_EQ(exported, now_) << "the test does not know what this does" << story_;
}

Step Robot::of(std::string method, Json params, std::function<void(Json&)> makes) {
  const auto way = below(4);
  if (way == 0) params["confirm_within"] = "600s";
  if (way == 1) params["probation"] = "9000000";
  if (way > 1) params["probation"] = "off";
  return {std::move(method), std::move(params), std::move(makes),
          way > 1 ? Step::Kind::applied : Step::Kind::trial};
}

Step Robot::set() {
  const std::string component = below(2) == 0 ? "first" : "second";
  const auto gain = some_gain();
  return of("param.set", {{"values", {{component + ".core.gain", gain}}}},
            [=](Json& system) { properties(system, component)["core.gain"] = gain; });
}

Step Robot::swap() {
  const std::vector<std::string> cores{"trial/steady", "trial/other", "trial/counting"};
  const auto core = cores[below(cores.size())];
  const auto gain = some_gain();
  return of("core.swap", {{"component", "first"}, {"core", core}, {"set", {{"gain", gain}}}},
            [=](Json& system) {
              system["components"]["first"]["core"] = core;
              properties(system, "first")["core.gain"] = gain;
            });
}

Step Robot::apply() {
  Json wanted = now_;
  properties(wanted, "first")["core.gain"] = some_gain();
  properties(wanted, "second")["core.gain"] = some_gain();
  auto& components = wanted["components"];
  if (components.contains("guest")) {
    components.erase("guest");
  } else {
    components["guest"] = components["first"];
    components["guest"].erase("ports");
  }
  return of("architecture.apply", {{"text", wanted.dump()}},
            [wanted](Json& system) { system = wanted; });
}

Step Robot::roll_back() {
  auto it = oracle_.all().begin();
  std::advance(it, below(oracle_.all().size()));
  const Json content = it->second.content;
  if (content.is_null() || content.dump().find(kFailing) != std::string::npos) return set();
  return {"config.rollback",
          {{"generation", it->first}, {"state", "drop"}},
          [this, content](Json& system) { system = oracle_.with_stops(content); },
          Step::Kind::trial};
}

Step Robot::stop_or_start() {
  const Json params = {{"components", {"second"}}};
  if (now_["components"]["second"].contains("start")) {
    return {"component.start", params,
            [](Json& system) { system["components"]["second"].erase("start"); }, Step::Kind::order};
  }
  return {"component.stop", params,
          [](Json& system) { system["components"]["second"]["start"] = false; }, Step::Kind::order};
}

void Robot::account(const Step& step, const Json& result) {
  EXPECT_TRUE(result.value("saved", false)) << step.method << ": " << result << story_;
  if (step.method == "component.stop") oracle_.stopped_by_user("second");
  if (step.method == "component.start") oracle_.started_by_user("second");
  if (step.method == "lock.set") lock_ = step.params["lock"];
  if (step.method == "quarantine.release") quarantined_ = false;
  if (step.kind == Step::Kind::confirm) return confirm();
  if (step.kind == Step::Kind::other || !result.value("changed", false)) return;
  if (!may_be_last(step)) return;
  const auto* before = oracle_.find(generation_);
  const auto its = before == nullptr ? Worth::either : before->worth;
  const auto number = result["generation"].get<std::uint64_t>();
  Kept next{now_, Worth::unconfirmed, step.method != "component.stop"};
  // A file that only starts or stops something has nothing to prove.
  const bool order = step.kind == Step::Kind::order ||
                     (step.method == "config.rollback" && !result.contains("probation"));
  if (step.kind == Step::Kind::undo) {
    undo(next);
  } else {
    step.makes(next.content);
    if (!order) open(step, result, next.content);
  }
  if (step.kind == Step::Kind::applied && open_.empty()) next.worth = Worth::confirmed;
  if (order) {
    next.worth = its;
    open_.order();
  }
  now_ = next.content;
  generation_ = number;
  oracle_.add(number, std::move(next));
}

std::map<std::string, Json> Robot::touched(const Step& step, const Json& next) const {
  std::map<std::string, Json> found;
  for (const std::string component : {"first", "second", "guest"}) {
    const Json before = now_["components"].value(component, Json());
    const bool swapped = step.method == "core.swap" && component == "first";
    const bool reloaded = step.method == "plugin.reload" && !before.is_null();
    if (swapped || reloaded || before != next["components"].value(component, Json())) {
      found[component] = before;
    }
  }
  return found;
}

void Robot::wait_for_quarantine(const Json& answer) {
  EXPECT_TRUE(eventually([&] {
    return TempDir::read(state_ / "quarantine.json").find(kFailing) != std::string::npos;
  })) << story_
      << "\n"
      << client_.ask("status.get") << client_.ask("quarantine.list");
  const auto newest = client_.ask("config.history", {{"n", 1}})["result"]["items"][0];
  Kept next{now_};
  open({"core.swap", Json::object(), {}, Step::Kind::trial}, answer, now_);
  undo(next);
  const auto number = newest["generation"].get<std::uint64_t>();
  for (auto made = generation_ + 1; made < number; ++made) oracle_.add(made, {});
  now_ = next.content;
  oracle_.add(number, std::move(next));
  generation_ = number;
  quarantined_ = true;
}

}  // namespace mauve::test
