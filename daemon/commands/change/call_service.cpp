// SPDX-License-Identifier: LGPL-3.0-or-later
/// service.call: a client writes to, calls or fires a service. The code of the resource runs on
/// [control], guarded like a value that is computed for a client: see look_outside.h.
#include <algorithm>
#include <cmath>
#include <memory>
#include <new>

#include "arch/text/value_json.h"
#include "commands/answer.h"
#include "commands/change/change.h"
#include "commands/look/value.h"
#include "commands/model.h"
#include "mauve/detail/port_base.h"
#include "mauve/host/architecture.h"
#include "mauve/host/resource.h"
#include "mauve/service.h"
#include "model/component/wiring.h"
#include "model/element/missing_fields.h"
#include "model/job/look_outside.h"

namespace mauve::daemon {

namespace {

/// Room for one value of a flat type, which needs no destructor.
class Room {
 public:
  explicit Room(const DataType& type) : type_(&type) {
    data_ = ::operator new(type.size, std::align_val_t(type.alignment));
    type.construct(data_);
  }
  ~Room() { ::operator delete(data_, std::align_val_t(type_->alignment)); }
  Room(const Room&) = delete;
  Room& operator=(const Room&) = delete;

  [[nodiscard]] void* data() const { return data_; }
  [[nodiscard]] const DataType& type() const { return *type_; }

 private:
  const DataType* type_;
  void* data_ = nullptr;
};
using Rooms = std::vector<std::unique_ptr<Room>>;

std::vector<const DataType*> arguments_of(const Signature& signature) {
  return signature.kind == PortKind::write ? std::vector{signature.data} : signature.arguments;
}

Result<ServiceBase*> service_at(const Running& running, const std::string& address) {
  const auto target = find_target(running, address);
  if (!target) {
    return target.error();
  }
  if (target->service == nullptr) {
    return refuse({Errc::type_mismatch, "not_a_service"}, address, "is no service",
                  "a service is written RESOURCE.NAME; mauvectl show RESOURCE lists them");
  }
  if (target->service->signature().kind == PortKind::read) {
    return refuse({Errc::type_mismatch, "service_takes_nothing"}, address,
                  "is a read service, which takes nothing",
                  "mauvectl get " + address + " reads it");
  }
  return target->service;
}

bool can_be_given(const DataType& type) {
  return type.flat && type.from_value != nullptr && type.construct != nullptr;
}

/// A value in which each field that `room` was not given has its default.
std::string whole_value(const Room& room) {
  constexpr std::size_t kShown = 300;
  const auto& type = room.type();
  const auto text = type.to_value == nullptr ? "" : to_string(type.to_value(room.data()));
  return text.empty() || text.size() > kShown ? "mauvectl show " + type.name + " lists them"
                                              : "a whole value: '" + text + "'";
}

/// A part of the value, or the value itself, is a NaN.
bool holds_nan(const Value& value) {
  if (const auto* number = value.get_if<double>()) {
    return std::isnan(*number);
  }
  if (const auto* items = value.get_if<Value::Array>()) {
    return std::ranges::any_of(*items, holds_nan);
  }
  const auto* fields = value.get_if<Value::Object>();
  return fields != nullptr &&
         std::ranges::any_of(*fields, holds_nan, &Value::Object::value_type::second);
}

Status fill(const std::string& at, const Json& json, const Room& room) {
  const auto value = arch::from_json(json);
  const auto& type = room.type();
  Status done = value ? type.from_value(*value, room.data()) : Status(value.error());
  if (done && type.to_value != nullptr && holds_nan(type.to_value(room.data()))) {
    return refuse({Errc::invalid_value, "value_out_of_range"}, at,
                  "is not a number, or has a field or an item that is none");
  }
  return done ? names_all_fields(at, room.type(), *value, whole_value(room))
              : detail::inside(std::move(done), at);
}

Result<Rooms> rooms_for(const ServiceBase& service, const Json& given) {
  const auto types = arguments_of(service.signature());
  const auto address = service.address();
  if (given.size() != types.size()) {
    return refuse({Errc::invalid_value, "argument_count"}, address,
                  "takes " + std::to_string(types.size()) +
                      (types.size() == 1 ? " argument" : " arguments") + ", got " +
                      std::to_string(given.size()),
                  "it is a " + to_string(service.signature()) + " service");
  }
  Rooms rooms;
  for (std::size_t i = 0; i < types.size(); ++i) {
    if (!can_be_given(*types[i])) {
      return refuse({Errc::unsupported, "type_not_plain"}, address,
                    "takes " + types[i]->name + ", which is not described or not plain bytes");
    }
    rooms.push_back(std::make_unique<Room>(*types[i]));
    const auto at = types.size() == 1 ? address : address + "[" + std::to_string(i) + "]";
    if (auto done = fill(at, given[i], *rooms.back()); !done) {
      return done.error();
    }
  }
  return rooms;
}

/// The result of a call, where there is one; a type that cannot be held or printed is refused.
Result<std::unique_ptr<Room>> room_for_result(const ServiceBase& service) {
  const auto* type = service.signature().result;
  if (type == nullptr || type->construct == nullptr) {
    return std::unique_ptr<Room>();
  }
  if (!type->flat || type->to_value == nullptr) {
    return refuse({Errc::unsupported, "type_not_plain"}, service.address(),
                  "answers with " + type->name + ", which is not described or not plain bytes");
  }
  return std::make_unique<Room>(*type);
}

/// Ports that use the same service: their values and the client's take turns.
Json users_of(const Running& running, const ServiceBase& service) {
  auto users = Json::array();
  const auto look = [&](const std::string& name, const Shell& shell, const Bindings& bindings) {
    for (const auto* port : shell.ports()) {
      const auto at = port->index();
      if (at < bindings.size() && bindings[at] != nullptr && &bindings[at]->service() == &service) {
        users.push_back(name + ".ports." + std::string(port->name()));
      }
    }
  };
  for (auto* component : running.architecture.components()) {
    look(component->name(), component->shell(), *component->bundle()->bindings);
  }
  for (auto* resource : running.architecture.resources()) {
    look(resource->name(), resource->shell(), resource->bindings());
  }
  return users;
}

/// A client would be a second writer of an output that is declared for one.
Status check_writer(const Running& running, const ServiceBase& service) {
  const auto writer = Wiring(running.architecture).only_writer(service);
  if (writer.empty()) {
    return ok();
  }
  return refuse({Errc::conflict, "writer_is_exclusive"}, service.address(),
                "is an output of one writer, and " + writer + " writes into it",
                "mauvectl disconnect " + writer + " first, or write where its component reads");
}

Status not_accepted(const ServiceBase& service) {
  const bool poisoned = service.resource().lock().poisoned();
  if (!poisoned) {
    return refuse({Errc::timed_out, "resource_busy"}, service.address(),
                  "its resource was busy for too long and took nothing", "try again");
  }
  return refuse({Errc::wrong_state, "resource_poisoned"}, service.address(),
                "its resource is poisoned and takes nothing",
                "give " + service.resource().name() + " a new core");
}

Status use(const Running& running, ServiceBase& service, const Rooms& rooms, void* result) {
  std::vector<void*> arguments;
  for (const auto& room : rooms) {
    arguments.push_back(room->data());
  }
  const auto accepted = use_outside(service, result, arguments.data());
  if (!accepted && service.resource().lock().poisoned()) {
    running.log.write(logging::Event::read_poisoned, {{"text", to_string(accepted.error())}});
  }
  if (!accepted) {
    return accepted.error();
  }
  return *accepted ? ok() : not_accepted(service);
}

}  // namespace

void call_service(Running& running, const CallPtr& call, Ticket /*none*/) {
  const auto service = service_at(running, text_or(call->params, "service"));
  if (!service) {
    return answer(running, *call, service.error());
  }
  if (auto alone = check_writer(running, **service); !alone) {
    return answer(running, *call, alone.error());
  }
  const auto given = call->params.value("arguments", Json::array());
  const auto rooms = rooms_for(**service, given);
  const auto room = room_for_result(**service);
  if (!rooms || !room) {
    return answer(running, *call, !rooms ? rooms.error() : room.error());
  }
  auto* const result = *room == nullptr ? nullptr : (*room)->data();
  if (auto done = use(running, **service, *rooms, result); !done) {
    return answer(running, *call, done.error());
  }
  Json receipt = {{"service", (*service)->address()},
                  {"kind", to_string((*service)->signature().kind)},
                  {"changed", true},
                  {"state", "applied"},
                  {"users", users_of(running, **service)},
                  {"generation", running.generation.load()}};
  if (result != nullptr) {
    receipt["result"] = arch::to_json((*room)->type().to_value(result));
  }
  answer(running, *call, std::move(receipt));
}

}  // namespace mauve::daemon
