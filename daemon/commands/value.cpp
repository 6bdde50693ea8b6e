// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/value.h"

#include "arch/built_in.h"
#include "arch/value_json.h"
#include "base/duration.h"

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
  if (service.signature().kind != PortKind::read) {
    return refuse(Errc::wrong_state, address,
                  "is a " + std::string(to_string(service.signature().kind)) +
                      " service, it has no value to read",
                  "watch it to see every value, or get the read service");
  }
  if (service.resource().type().name == arch::kRingBuffer) {
    return refuse(Errc::unsupported, address, "is a queue: reading would take an item away",
                  "watch it, or get " + service.resource().name() + ".core.size");
  }
  if (type == nullptr || type->to_value == nullptr) {
    return refuse(Errc::unsupported, address, "its type has no description",
                  "describe it: specialise mauve::Described");
  }
  Slot slot(service);
  Json value;
  auto encode = [&](const void* data) { value = arch::to_json(type->to_value(data)); };
  const auto status = service.look(Visitor(encode), slot.cursor);
  auto out = answer_for(address, std::move(value), to_string(status));
  if (has_value(status)) {
    out["t_ns"] = slot.cursor.stamp - running.deployer.t0();
    out["age_ns"] = running.deployer.clock().now() - slot.cursor.stamp;
  }
  return out;
}

/// What the port knows more than the service: where its values come from and how old they may be.
void add_connection(Json& out, const Binding& binding) {
  out["service"] = binding.service().address();
  out["max_age"] = max_age_of(&binding);
  const auto limit = binding.max_age();
  if (limit > Duration{0} && out.contains("age_ns") && out["age_ns"] > limit.count()) {
    out["status"] = to_string(DataStatus::stale);
  }
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
    return answer_for(address, arch::to_json(target.observable->value()), "current");
  }
  auto* service = service_of(target);
  if (service == nullptr) {
    auto out = answer_for(address, nullptr, to_string(DataStatus::no_data));
    out["service"] = nullptr;
    return out;
  }
  const bool is_port = target.port != nullptr;
  if (is_port && service->signature().kind != PortKind::read) {
    auto out = answer_for(address, nullptr, to_string(DataStatus::no_data));
    out["service"] = service->address();
    return out;
  }
  auto out = read_service(running, address, *service);
  if (out && is_port) {
    add_connection(*out, *connection(target.element, *target.port));
  }
  return out;
}

}  // namespace mauve::daemon
