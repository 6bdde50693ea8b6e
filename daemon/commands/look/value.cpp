// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/look/value.h"

#include <optional>

#include "arch/compare/task_attributes.h"
#include "arch/parse/built_in.h"
#include "arch/parse/part_of_value.h"
#include "arch/text/value_json.h"
#include "base/duration.h"
#include "mauve/host/resource.h"
#include "mauve/observable.h"
#include "mauve/property.h"
#include "mauve/service.h"
#include "model/job/look_outside.h"

namespace mauve::daemon {

namespace {

Json answer_for(const std::string& address, Json value, std::string_view status) {
  return {{"address", address}, {"value", std::move(value)}, {"status", status}};
}

/// A reader slot of its own for the time of one read.
class Slot {
 public:
  explicit Slot(ServiceBase& service) : service_(service) { cursor.slot = service.attach(); }
  ~Slot() { service_.detach(cursor.slot); }
  Slot(const Slot&) = delete;
  Slot& operator=(const Slot&) = delete;

  Cursor cursor;

 private:
  ServiceBase& service_;
};

Result<Json> read_service(const Running& running, const std::string& address,
                          ServiceBase& service) {
  const auto* type = service.signature().data;
  const auto kind = service.signature().kind;
  if (kind != PortKind::read) {
    const auto word = std::string(to_string(kind));
    return refuse(
        {Errc::wrong_state, "service_has_no_value"}, address,
        (kind == PortKind::event ? "is an " : "is a ") + word + " service, it has no value to read",
        service.taps() != nullptr
            ? "mauvectl get " + service.resource().name() + ".read has the last value"
            : "mauvectl show " + address + " shows its types");
  }
  if (service.resource().type().name == arch::kRingBuffer) {
    return refuse({Errc::unsupported, "queue_not_readable"}, address,
                  "is a queue: reading would take an item away",
                  "watch it, or get " + service.resource().name() + ".core.size");
  }
  if (type == nullptr || type->to_value == nullptr) {
    return refuse({Errc::unsupported, "type_not_described"}, address, "its type has no description",
                  "describe it: a static type_name and fields(), see mauve/type.h");
  }
  Slot slot(service);
  Json value;
  auto encode = [&](const void* data) { value = arch::to_json(type->to_value(data)); };
  const auto status = look_outside(service, Visitor(encode), slot.cursor);
  if (!status) {
    if (service.resource().lock().poisoned()) {
      running.log.write(logging::Event::read_poisoned, {{"text", to_string(status.error())}});
    }
    return status.error();
  }
  auto out = answer_for(address, std::move(value), to_string(*status));
  if (has_value(*status)) {
    out["t_ns"] = slot.cursor.stamp - running.deployer.t0();
    out["age_ns"] = running.deployer.clock().now() - slot.cursor.stamp;
  }
  return out;
}

/// The facts that the port knows in addition to the service: the origin of its values, and how old
/// they may be.
void add_connection(Json& out, const Binding& binding) {
  out["service"] = binding.service().address();
  out["max_age"] = max_age_of(&binding);
  const auto limit = binding.max_age();
  if (limit > Duration{0} && out.contains("age_ns") && out["age_ns"] > limit.count()) {
    out["status"] = to_string(DataStatus::stale);
  }
}

/// Of a port that does not read: the service that it leads to, and the value that was written there
/// last, where that is stored.
Result<Json> sample_output(const Running& running, const std::string& address,
                           ServiceBase& service) {
  const auto kind = service.signature().kind;
  const bool stored = kind == PortKind::write && service.exchange() != nullptr;
  auto* const reading = stored ? service.resource().find_service("read") : nullptr;
  auto out = reading != nullptr
                 ? read_service(running, address, *reading)
                 : Result<Json>(answer_for(address, nullptr, to_string(DataStatus::no_data)));
  if (out) {
    (*out)["service"] = service.address();
    (*out)["kind"] = to_string(kind);
  }
  return out;
}

Value statistic(const ComponentStatus& status, std::string_view name) {
  const auto count = [](std::uint64_t number) { return Value(static_cast<std::int64_t>(number)); };
  if (name == "state") {
    return to_string(status.state);
  }
  if (name == "core") {
    return status.core;
  }
  if (name == "fsm_state") {
    return status.fsm_state;
  }
  if (name == "releases") {
    return count(status.releases);
  }
  if (name == "missed") {
    return count(status.missed);
  }
  if (name == "overruns") {
    return count(status.overruns);
  }
  if (name == "over_budget") {
    return count(status.over_budget);
  }
  if (name == "implausible") {
    return count(status.implausible_of_core);
  }
  return format_duration(name == "late"           ? status.late
                         : name == "lateness_max" ? status.lateness_max
                                                  : status.elapsed_max);
}

/// Of an observable. One that was never written is as old as the first job of its core; nothing:
/// the core has run none.
std::optional<Duration> age_of(const Running& running, const Target& target) {
  const auto& deployer = running.deployer;
  auto written = target.observable->written();
  if (written == 0 && target.element.component != nullptr) {
    const auto since = deployer.statistics(target.element.name()).since;
    written = since == Duration{0} ? 0 : deployer.t0() + since.count();
  } else if (written == 0) {
    written = deployer.t0();
  }
  return written == 0 ? std::nullopt : std::optional(Duration{deployer.clock().now() - written});
}

/// "324.3ms": nobody reads nanoseconds of an age.
Value age_in_words(Duration age) {
  const Duration step = age < 1ms ? Duration{1us} : age < 1s ? Duration{100us} : Duration{1ms};
  return format_duration(age - age % step);
}

/// A warning is written when it changes, and a count is 0 before it is written first. That they are
/// old says nothing, as long as their component runs: else nobody would write them.
bool has_no_age(const ObservableBase& observable) {
  return dynamic_cast<const Warning*>(&observable) != nullptr ||
         (observable.written() == 0 && same_type(observable.type(), data_type<std::uint64_t>()));
}

bool is_too_old(std::optional<Duration> age, Duration max_age) {
  return max_age > Duration{0} && (!age || *age > max_age);
}

bool stands(const Running& running, const arch::Element& element) {
  return element.component != nullptr &&
         running.deployer.status(element.name()).state != ComponentState::running;
}

Value look_at(const Running& running, const arch::Quantity& quantity, Duration max_age) {
  const auto& target = quantity.target;
  const bool wants_age = quantity.aspect == arch::Quantity::Aspect::age;
  if (!wants_age && max_age == Duration{0}) {
    return target.observable->value();
  }
  const auto age = age_of(running, target);
  if (wants_age) {
    return age ? age_in_words(*age) : Value();
  }
  const bool old =
      has_no_age(*target.observable) ? stands(running, target.element) : is_too_old(age, max_age);
  return old ? Value() : target.observable->value();
}

/// Of a service or port that reads shared data.
Value look_at(const Running& running, const arch::Quantity& quantity, ServiceBase& service,
              Duration max_age) {
  using Aspect = arch::Quantity::Aspect;
  Slot slot(service);
  Value value;
  auto decode = [&](const void* data) {
    if (quantity.aspect == Aspect::value) {
      value = arch::field_of(service.signature().data->to_value(data), quantity.fields);
    }
  };
  auto status = service.look(Visitor(decode), slot.cursor);
  const Duration age{running.deployer.clock().now() - slot.cursor.stamp};
  if (quantity.target.port != nullptr && has_value(status)) {
    const auto limit = connection(quantity.target.element, *quantity.target.port)->max_age();
    status = limit > Duration{0} && age > limit ? DataStatus::stale : status;
  }
  if (quantity.aspect == Aspect::status) {
    return to_string(status);
  }
  if (!has_value(status)) {
    return {};
  }
  if (quantity.aspect == Aspect::age) {
    return age_in_words(age);
  }
  return is_too_old(age, max_age) ? Value() : value;
}

}  // namespace

Json max_age_of(const Binding* binding) {
  return binding == nullptr || binding->max_age() == Duration{0}
             ? Json()
             : Json(format_duration(binding->max_age()));
}

ServiceBase* service_of(const Target& target) {
  if (target.port == nullptr) {
    return target.service;
  }
  const auto* binding = connection(target.element, *target.port);
  return binding == nullptr ? nullptr : &binding->service();
}

Result<Json> sample(const Running& running, const std::string& address, const Target& target) {
  if (target.property != nullptr) {
    return answer_for(address, arch::to_json(target.property->value()), "current");
  }
  if (target.observable != nullptr) {
    auto out = answer_for(address, arch::to_json(target.observable->value()), "current");
    if (const auto written = target.observable->written(); written != 0) {
      out["t_ns"] = written - running.deployer.t0();
      out["age_ns"] = running.deployer.clock().now() - written;
    }
    return out;
  }
  auto* service = service_of(target);
  if (service == nullptr) {
    auto out = answer_for(address, nullptr, to_string(DataStatus::no_data));
    out["service"] = nullptr;
    return out;
  }
  const bool is_port = target.port != nullptr;
  if (is_port && service->signature().kind != PortKind::read) {
    return sample_output(running, address, *service);
  }
  auto out = read_service(running, address, *service);
  if (out && is_port) {
    add_connection(*out, *connection(target.element, *target.port));
  }
  return out;
}

namespace {

/// "control.task.budget"; nothing: the address is of something else.
std::optional<Result<Json>> sample_task(const Running& running, const std::string& address) {
  constexpr std::string_view kTask = ".task.";
  const auto dot = address.find(kTask);
  if (dot == std::string::npos || address.find('.') != dot) {
    return std::nullopt;
  }
  const auto component = find_component(running, address.substr(0, dot));
  if (!component) {
    return component.error();
  }
  auto value = arch::attribute_of((*component)->bundle()->task, address.substr(0, dot) + ".task",
                                  std::string_view(address).substr(dot + kTask.size()));
  if (!value) {
    return value.error();
  }
  return answer_for(address, arch::to_json(*value), "current");
}

}  // namespace

Result<Json> sample_at(const Running& running, const std::string& address) {
  if (auto attribute = sample_task(running, address)) {
    return *std::move(attribute);
  }
  const auto target = find_target(running, address);
  if (target) {
    return sample(running, address, *target);
  }
  const auto quantity = arch::find_quantity(running.architecture, address);
  if (!quantity) {
    return arch::part_not_read(running.architecture, address, target.error());
  }
  const auto value = read(running, *quantity);
  if (!value) {
    return value.error();
  }
  return answer_for(address, arch::to_json(*value), "current");
}

Result<Value> read(const Running& running, const arch::Quantity& quantity, Duration max_age) {
  const auto& target = quantity.target;
  if (!quantity.statistic.empty()) {
    return statistic(running.deployer.status(target.element.name()), quantity.statistic);
  }
  if (target.property != nullptr) {
    return arch::field_of(target.property->value(), quantity.fields);
  }
  if (target.observable != nullptr) {
    return look_at(running, quantity, max_age);
  }
  auto* service = service_of(target);
  if (service == nullptr) {
    const bool status = quantity.aspect == arch::Quantity::Aspect::status;
    return status ? Value(to_string(DataStatus::no_data)) : Value();
  }
  if (service->resource().type().name != arch::kSharedData) {
    return refuse({Errc::unsupported, "value_not_stored"}, service->address(),
                  "is not stored but made for each reader", "mauvectl get " + service->address());
  }
  return look_at(running, quantity, *service, max_age);
}

}  // namespace mauve::daemon
