// SPDX-License-Identifier: LGPL-3.0-or-later
/// `mauvectl doctor`: collects facts, judges them, and names remedies.
#include <gnu/libc-version.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>

#include "base/duration.h"
#include "commands/actions.h"
#include "doctor/checks.h"
#include "doctor/wake.h"
#include "render/table.h"
#include "render/words.h"
#include "rt/machine/machine_costs.h"
#include "rt/thread/thread.h"

namespace mauve::ctl {
namespace {

using doctor::Facts;
using doctor::Finding;
using doctor::Grade;

struct Named {
  std::string_view check;
  Finding finding;
};

/// False: there is no daemon, and no need to ask again.
bool ask_into(Session& session, Facts& facts, std::string_view method, Json& answer) {
  auto said = session.call(method, Json::object());
  if (const auto* fault = std::get_if<Fault>(&said)) {
    facts.no_daemon = fault->message;
    facts.hint = fault->hint;
    return fault->exit != static_cast<int>(protocol::Exit::unreachable);
  }
  answer = std::get<Json>(std::move(said));
  return true;
}

Facts gather(Session& session) {
  Facts facts;
  facts.socket = session.globals.socket;
  facts.client = MAUVE_VERSION;
  facts.glibc = gnu_get_libc_version();
  facts.group = doctor::group_of_caller();
  if (ask_into(session, facts, "version", facts.version) &&
      ask_into(session, facts, "status.get", facts.status)) {
    ask_into(session, facts, "daemon.doctor", facts.daemon);
  }
  return facts;
}

/// Those that are set apart as well: that is where components belong.
std::vector<int> measured_cpus(const Facts& facts) {
  std::set<int> cpus;
  for (const int cpu : rt::usable_cpus()) cpus.insert(cpu);
  const auto isolated = facts.text("sys/devices/system/cpu/isolated");
  for (const int cpu : doctor::cpus_in(isolated.value_or(""))) cpus.insert(cpu);
  return {cpus.begin(), cpus.end()};
}

Paint paint_of(Grade grade) {
  if (grade == Grade::ok) return Paint::green;
  return grade == Grade::warn ? Paint::yellow : Paint::red;
}

constexpr std::size_t kIndent = 6;

std::string render(const Named& one, Look look) {
  const auto [grade, found, remedy] = one.finding;
  std::string label(to_string(grade));
  label.resize(kIndent, ' ');
  const std::string sentence = std::string(one.check) + ": " + harmless(found);
  std::string text = painted(label, paint_of(grade), look.colour);
  text += wrapped(sentence, look.width > 2 * kIndent ? look.width - kIndent : 0, 0) + "\n";
  for (std::size_t at = text.find('\n'); at + 1 < text.size(); at = text.find('\n', at + 1)) {
    text.insert(at + 1, kIndent, ' ');
  }
  // Not broken into lines: it is there to be copied.
  if (!remedy.empty()) text += std::string(kIndent, ' ') + "remedy: " + harmless(remedy) + "\n";
  return text;
}

/// The costs that admission may assume of this machine, as a value of --machine. 99 % of the
/// wake-ups took no longer than its `wake`; the other costs are measured now. The measurement does
/// not run beside components, because it would delay them.
std::optional<std::string> proposal(const Facts& facts, const std::vector<doctor::Wakes>& wakes) {
  if (wakes.empty() || !facts.status.is_null()) return std::nullopt;
  auto costs = rt::measure_machine(measured_cpus(facts), doctor::kWakePriority);
  if (!costs) return std::nullopt;
  costs->wake = Duration{0};
  for (const auto& one : wakes) costs->wake = std::max(costs->wake, Duration{one.percentile(99)});
  costs->wake = std::chrono::ceil<std::chrono::microseconds>(costs->wake);
  if (std::max(costs->wake, costs->kernel) >= MachineCosts::window) return std::nullopt;
  return "--machine wake=" + format_duration(costs->wake) +
         ",switch=" + format_duration(costs->activation) +
         ",timer=" + format_duration(costs->interrupt) +
         ",kernel=" + format_duration(costs->kernel);
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(c | 0x20);
  return result;
}

Json json_of(const std::vector<Named>& all, Grade grade) {
  Json findings = Json::array();
  for (const auto& [check, finding] : all) {
    findings.push_back({{"check", check},
                        {"grade", lower(to_string(finding.grade))},
                        {"found", finding.found},
                        {"remedy", finding.remedy}});
  }
  return {{"grade", lower(to_string(grade))}, {"findings", std::move(findings)}};
}

std::string summary(const std::vector<Named>& all) {
  std::array<std::size_t, 3> counts{};
  for (const Named& one : all) ++counts.at(static_cast<std::size_t>(one.finding.grade));
  return std::to_string(counts[0]) + " OK, " + std::to_string(counts[1]) + " WARN, " +
         std::to_string(counts[2]) + " FAIL\n";
}

}  // namespace

int run_doctor(Session& session) {
  const std::string asked = session.arguments.one("--wake");
  const auto time = timeout_of(asked);
  if (!asked.empty() && (!time || *time > std::chrono::minutes(10))) {
    return session.fail(protocol::wrong_use(
        "usage_not_a_time", "not a time to measure, at most 10min", asked, "example: --wake 10s"));
  }
  const Facts facts = gather(session);
  std::vector<Named> all;
  for (const auto& check : doctor::checks()) all.push_back({check.name, check.look(facts)});
  std::vector<doctor::Wakes> wakes;
  if (time) {
    session.screen.err << "measuring for " << asked << "\n";
    wakes = doctor::measure_wakes(*time, measured_cpus(facts));
    all.push_back({"wake-up latency", doctor::judge_wakes(wakes)});
  }
  const auto machine = proposal(facts, wakes);
  Grade worst = Grade::ok;
  std::string text;
  for (const Named& one : all) {
    worst = std::max(worst, one.finding.grade);
    text += render(one, session.look());
  }
  Json result = json_of(all, worst);
  if (time) result["wake"] = doctor::wakes_json(wakes);
  std::string assume;
  if (machine) {
    result["machine"] = *machine;
    assume = "admission may assume of this machine: mauved " + *machine + "\n";
  }
  session.print(result, text + doctor::render_wakes(wakes, session.look()) + assume + summary(all));
  return worst == Grade::fail ? 1 : 0;
}

}  // namespace mauve::ctl
