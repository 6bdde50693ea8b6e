// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/host/deployer.h>

#include "exec/admission/admission.h"

#include "base/thread_role.h"
#include "exec/commit/commit.h"
#include "exec/commit/under_way.h"
#include "exec/deploy/bring_up.h"
#include "exec/deploy/direct_stop.h"
#include "exec/deploy/in_place.h"
#include "exec/deploy/shutdown.h"
#include "exec/deploy/stop.h"
#include "exec/observe/component_status.h"
#include "exec/observe/statistics.h"
#include "exec/observe/traced.h"
#include "exec/prepare/foresee.h"
#include "exec/prepare/prepare.h"
#include "exec/recovery/standby.h"
#include "exec/system/events.h"
#include "exec/system/report_control.h"
#include "exec/system/trace_records.h"
#include "rt/time/measured.h"

#include <mauve/detail/job.h>
#include <mauve/host/architecture.h>

namespace mauve {
namespace {

/// "control.core.gain" -> {"control", "core.gain"}.
std::pair<std::string, std::string> split_owner(std::string_view address) {
  const auto dot = address.find('.');
  if (dot == std::string_view::npos) return {std::string(address), {}};
  return {std::string(address.substr(0, dot)), std::string(address.substr(dot + 1))};
}

/// "control.ports.scan" -> {"control", "scan"}.
Result<std::pair<std::string, std::string>> split_port(std::string_view address) {
  auto [owner, rest] = split_owner(address);
  constexpr std::string_view kPorts = "ports.";
  if (rest.rfind(kPorts, 0) != 0) {
    return refuse({Errc::unknown_name, "unknown_port"}, std::string(address), "is no port",
                  "ports are written COMPONENT.ports.NAME");
  }
  return std::pair{owner, rest.substr(kPorts.size())};
}

}  // namespace

Deployer::Deployer(Architecture& architecture, DeployOptions options)
    : system_(std::make_unique<exec::System>(architecture, options)) {}

Deployer::~Deployer() { shutdown(); }

Status Deployer::deploy() { return exec::bring_up(*system_); }

std::vector<std::string> Deployer::shutdown(Duration bound, Duration ordinary) {
  return exec::bring_down(*system_, bound, ordinary);
}

Instant Deployer::t0() const { return system_->t0; }
const Clock& Deployer::clock() const { return system_->runner->clock(); }
std::uint64_t Deployer::generation(bool before_stops) const {
  return before_stops ? system_->generation_before_stops() : system_->generation;
}
const std::vector<std::string>& Deployer::warnings() const { return system_->warnings; }

bool Deployer::realtime() const {
  for (const exec::Deployed& deployed : system_->deployed) {
    if (!deployed.realtime) return false;
  }
  return system_->up;
}

std::vector<ComponentStatus> Deployer::status() const {
  exec::advance(*system_);
  std::vector<ComponentStatus> all;
  for (const exec::Deployed& deployed : system_->deployed) {
    if (!deployed.hidden) all.push_back(exec::look_at(*system_, deployed));
  }
  return all;
}

ComponentStatus Deployer::status(std::string_view component) const {
  exec::advance(*system_);
  const exec::Deployed* deployed = system_->find(component);
  return deployed == nullptr || deployed->task == nullptr ? ComponentStatus{}
                                                          : exec::look_at(*system_, *deployed);
}

std::vector<ComponentStatistics> Deployer::statistics() const {
  exec::advance(*system_);
  std::vector<ComponentStatistics> all;
  for (const exec::Deployed& deployed : system_->deployed) {
    if (!deployed.hidden) all.push_back(exec::statistics_of(*system_, deployed));
  }
  return all;
}

ComponentStatistics Deployer::statistics(std::string_view component) const {
  exec::advance(*system_);
  const exec::Deployed* deployed = system_->find(component);
  return deployed == nullptr ? ComponentStatistics{} : exec::statistics_of(*system_, *deployed);
}

Status Deployer::reset_statistics(std::string_view component) {
  exec::advance(*system_);
  if (!component.empty()) {
    const Result<ComponentBase*> known = system_->component(component);
    if (!known) return known.error();
  }
  for (exec::Deployed& deployed : system_->deployed) {
    const ComponentBase* one = deployed.component;
    if (component.empty() || one->name() == component) one->bundle()->measured->reset();
  }
  return ok();
}

Timing Deployer::analyze() const {
  exec::advance(*system_);
  return exec::analyze(*system_);
}

Result<PreparedChange> Deployer::prepare(const Change& change) {
  Result<PreparedChange> prepared = exec::prepare_change(*system_, change);
  if (prepared) {
    exec::report_control(*system_, TraceKind::prepare, prepared->content().what, 0, 0);
  }
  return prepared;
}

Receipt Deployer::foresee(PreparedChange& change) const {
  return exec::foresee(*system_, change.content());
}

std::shared_ptr<Ongoing> Deployer::begin(PreparedChange& change) {
  return exec::begin_commit(*system_, change);
}

Result<Receipt> Deployer::wait(Ongoing& ongoing) {
  // Ends by itself: every step of it is bounded.
  static_cast<void>(system_->runner->await([&ongoing] { return ongoing.advance(); }, exec::kNever));
  return ongoing.result();
}

Result<Receipt> Deployer::commit(PreparedChange& change, Retired& retired) {
  const std::shared_ptr<Ongoing> ongoing = begin(change);
  Result<Receipt> receipt = wait(*ongoing);
  retired = std::move(ongoing->retired());
  return receipt;
}

Result<Receipt> Deployer::apply(const Change& change) {
  Result<PreparedChange> prepared = prepare(change);
  if (!prepared) return prepared.error();
  Retired retired;
  return commit(*prepared, retired);
}

bool Deployer::on_probation() const {
  exec::advance(*system_);
  const auto& all = system_->probations;
  return std::any_of(all.begin(), all.end(), [](const auto& one) { return one->open(); });
}

bool Deployer::going_back() const {
  exec::advance(*system_);
  const auto& all = system_->probations;
  return std::any_of(all.begin(), all.end(), [](const auto& one) { return !one->open(); });
}

std::vector<OpenProbation> Deployer::probations() const {
  exec::advance(*system_);
  std::vector<OpenProbation> all;
  for (const auto& one : system_->probations) {
    if (!one->reported()) all.push_back(one->look());
  }
  return all;
}

Status Deployer::confirm() {
  bool passed = false;
  exec::advance(*system_);
  for (const auto& one : system_->probations) passed = one->pass("confirmed") || passed;
  if (passed) {
    exec::advance(*system_);
    return ok();
  }
  return refuse({Errc::wrong_state, "nothing_on_probation"}, {},
                "generation " + std::to_string(generation()) +
                    " is not on probation, so there is nothing to confirm");
}

// The undo takes back what a user was shown: nothing takes the system further in between.
Status Deployer::undo(const std::string& reason, const std::vector<std::uint64_t>& shown) {
  if (shown.empty()) exec::advance(*system_);
  const auto& all = system_->probations;
  const auto undone = std::find_if(all.rbegin(), all.rend(), [&](const auto& one) {
    const bool meant = shown.empty() || one->generations() == shown;
    return meant && one->open() && one->undo(reason);
  });
  if (undone != all.rend()) return ok();
  return refuse({Errc::wrong_state, "nothing_to_undo"}, {},
                "generation " + std::to_string(shown.empty() ? generation() : shown.back()) +
                    " is not on probation, so there is nothing to undo",
                "roll back to a saved generation");
}

std::vector<Outcome> Deployer::tend(Retired& retired) {
  retired.merge(collect());
  return std::exchange(system_->outcomes, {});
}

Retired Deployer::collect() {
  exec::advance(*system_);
  // An abandoned thread may still be inside.
  if (system_->runner->has_abandoned()) return {};
  return std::exchange(system_->retired, {});
}

bool Deployer::settled() const {
  exec::advance(*system_);
  return system_->fading.empty() && !exec::holds_stale_standby(*system_);
}

std::vector<Change> Deployer::wanted_standby_cores() const {
  exec::advance(*system_);
  return exec::wanted_standby_cores(*system_);
}

Result<PreparedChange> Deployer::prepare_standby(const Change& standby) {
  Result<PreparedChange> prepared = prepare(standby);
  if (!prepared) return exec::about_standby(standby, prepared.error());
  return prepared;
}

void Deployer::refuse_standby(std::string_view component, const std::string& why) {
  exec::advance(*system_);
  exec::refuse_standby(*system_, component, why);
}

void Deployer::stand_by(PreparedChange& standby) {
  exec::advance(*system_);  // not while it was prepared
  exec::put_in_readiness(*system_, standby);
}

Result<Receipt> Deployer::start(const std::vector<std::string>& components, bool reset) {
  Change change;
  change.ends_stops = true;
  for (const std::string& name : components) {
    const Result<ComponentBase*> component = system_->component(name);
    if (!component) return component.error();
    if (status(name).state == ComponentState::running) {
      return refuse({Errc::wrong_state, "runs_already"}, name, "is running already");
    }
    Edit edit;
    edit.member = name;
    edit.mode = Mode::run;
    if (reset) edit.core = (*component)->bundle()->core_type;
    if (reset) edit.state = StatePolicy::drop;
    change.edits.push_back(std::move(edit));
  }
  return apply(change);
}

Result<std::shared_ptr<Ongoing>> Deployer::begin_stop(const std::vector<std::string>& components,
                                                      const std::optional<UserStop>& by) {
  return exec::begin_stop(*system_, components, by);
}

std::shared_ptr<Ongoing> Deployer::begin_stop_all(Duration bound, const UserStop& by) {
  return exec::begin_stop_all(*system_, bound, by);
}

std::unique_ptr<DirectStop> Deployer::begin_direct_stop(
    const std::vector<std::string>& components) {
  return exec::begin_direct_stop(*system_, components);
}

void Deployer::end_direct_stop(const std::vector<std::string>& components) {
  exec::end_direct_stop(*system_, components);
}

std::uint64_t Deployer::looks() const { return system_->looks.load(); }
void Deployer::stand_still(bool still) { system_->stands_still += still ? 1 : -1; }

Result<Receipt> Deployer::stop(const std::vector<std::string>& components) {
  const Result<std::shared_ptr<Ongoing>> stopping = begin_stop(components);
  if (!stopping) return stopping.error();
  return wait(**stopping);
}

Result<Receipt> Deployer::stop_all(Duration bound) { return wait(*begin_stop_all(bound)); }

Result<Receipt> Deployer::swap_core(std::string_view component, const CoreType& core,
                                    StatePolicy state) {
  Edit edit;
  edit.member = component;
  edit.core = core;
  edit.state = state;
  return apply({{edit}});
}

Result<Receipt> Deployer::set(std::string_view address, const Value& value, StatePolicy state) {
  auto [owner, path] = split_owner(address);
  Edit edit;
  edit.member = owner;
  edit.properties.emplace_back(path, value);
  edit.state = state;
  return apply({{edit}});
}

Result<Receipt> Deployer::connect(std::string_view port, std::string_view service,
                                  Duration max_age) {
  auto parts = split_port(port);
  if (!parts) return parts.error();
  Edit edit;
  edit.member = parts->first;
  edit.connect.push_back({parts->second, std::string(service), max_age});
  return apply({{edit}});
}

Result<Receipt> Deployer::disconnect(std::string_view port) {
  auto parts = split_port(port);
  if (!parts) return parts.error();
  Edit edit;
  edit.member = parts->first;
  edit.disconnect.push_back(parts->second);
  return apply({{edit}});
}

std::size_t Deployer::drain(const std::function<void(const RuntimeEvent&)>& visit) {
  MAUVE_ON_THREAD(log);
  return exec::drain_events(*system_, visit);
}

std::size_t Deployer::drain_trace(const std::function<void(const TraceRecord&)>& visit) {
  MAUVE_ON_THREAD(trace);
  return exec::drain_trace(*system_, visit);
}

TracedSystem Deployer::traced() const {
  exec::advance(*system_);
  return exec::traced(*system_);
}

void Deployer::run_for(Duration duration) {
  system_->runner->run_until(system_->runner->now() + duration.count());
}

// --- in place: see in_place.h -----------------------------------------------------------------

Result<PreparedChange> Deployer::prepare_in_place(const Edit& edit,
                                                  std::optional<std::uint64_t> made_from) {
  return exec::prepare_in_place(*system_, edit, made_from);
}

Result<PreparedChange> Deployer::prepare_back_in_place(std::string_view component,
                                                       std::shared_ptr<const Bundle> before,
                                                       std::optional<ComponentType> type) {
  return exec::prepare_back_in_place(*system_, component, std::move(before), std::move(type));
}

std::shared_ptr<Ongoing> Deployer::begin_in_place_park(PreparedChange& change) {
  return exec::begin_in_place_park(*system_, change);
}

Status Deployer::in_place_exchange(PreparedChange& change) {
  return exec::in_place_exchange(*system_, change);
}

Result<std::shared_ptr<Ongoing>> Deployer::begin_in_place_resume(PreparedChange& change,
                                                                 const Status& exchanged) {
  return exec::begin_in_place_resume(*system_, change, exchanged);
}

Result<Receipt> Deployer::swap_core_in_place(const Edit& edit) {
  Result<PreparedChange> change = prepare_in_place(edit);
  if (!change) return change.error();
  const Result<Receipt> parked = wait(*begin_in_place_park(*change));
  if (!parked) return parked.error();
  const Status exchanged = in_place_exchange(*change);
  const Result<std::shared_ptr<Ongoing>> resumed = begin_in_place_resume(*change, exchanged);
  if (!resumed) return resumed.error();
  Result<Receipt> receipt = wait(**resumed);
  if (!exchanged) return exchanged.error();
  return receipt;
}

}  // namespace mauve
