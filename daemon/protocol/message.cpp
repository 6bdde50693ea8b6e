// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/message.h"

#include <array>
#include <utility>

namespace mauve::protocol {
namespace {

struct OwnCode {
  Errc errc;
  int code;
  Exit exit;
};

// The order of the wire, not of the enumeration: a number never changes its meaning.
constexpr std::array<OwnCode, 17> kOwnCodes{{
    {Errc::abi_mismatch, -32010, Exit::refused},
    {Errc::invalid_value, -32011, Exit::refused},
    {Errc::unknown_name, -32012, Exit::no_such_object},
    {Errc::duplicate, -32013, Exit::refused},
    {Errc::type_mismatch, -32014, Exit::refused},
    {Errc::wrong_state, -32015, Exit::refused},
    {Errc::hook_failed, -32016, Exit::refused},
    {Errc::hook_threw, -32017, Exit::refused},
    {Errc::cycle, -32018, Exit::refused},
    {Errc::plugin_refused, -32019, Exit::refused},
    {Errc::not_permitted, -32020, Exit::permission},
    {Errc::conflict, -32021, Exit::conflict},
    {Errc::timed_out, -32022, Exit::timed_out},
    {Errc::limit, -32023, Exit::refused},
    {Errc::unsupported, -32024, Exit::refused},
    {Errc::system, -32025, Exit::refused},
    {Errc::partly, -32026, Exit::partly},
}};

struct RpcCode {
  int code;
  std::string_view name;
  Exit exit;
};

constexpr std::array<RpcCode, 8> kRpcCodes{{
    {kParseError, "parse_error", Exit::usage},
    {kInvalidRequest, "invalid_request", Exit::usage},
    {kUnknownMethod, "unknown_method", Exit::usage},
    {kInvalidParams, "invalid_params", Exit::usage},
    {kInternal, "internal", Exit::refused},
    {kUnreachable, "unreachable", Exit::unreachable},
    {kBadAnswer, "bad_answer", Exit::unreachable},
    {kUsage, "usage", Exit::usage},
}};

bool is_id(const Json& id) { return id.is_string() || id.is_number_integer(); }

std::string text_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string{};
}

Json take(Json& object, const char* key, Json otherwise) {
  const auto found = object.find(key);
  return found == object.end() ? std::move(otherwise) : std::move(*found);
}

/// The fault of the envelope; empty when there is none.
std::string envelope_fault(const Json& line) {
  if (line.is_array()) return "batches are not accepted, send one request a line";
  if (!line.is_object()) return "a request is a JSON object";
  if (text_of(line, "jsonrpc") != "2.0") return "\"jsonrpc\" must be \"2.0\"";
  if (!line.contains("id")) return "\"id\" is missing, every request gets an answer";
  if (!is_id(line["id"])) return "\"id\" must be a string or an integer";
  if (text_of(line, "method").empty()) return "\"method\" must be a string";
  for (const auto& [key, value] : line.items()) {
    if (key != "jsonrpc" && key != "id" && key != "method" && key != "params") {
      return "unknown member \"" + key.substr(0, 64) + "\"";
    }
  }
  return {};
}

Json known_id(const Json& line) {
  if (!line.is_object() || !line.contains("id") || !is_id(line["id"])) return nullptr;
  return line["id"];
}

Fault fault_from_json(const Json& error) {
  Fault fault;
  fault.message = text_of(error, "message");
  if (const auto code = error.find("code"); code != error.end() && code->is_number_integer()) {
    fault = fault_of(code->get<int>(), std::move(fault.message));
  }
  const auto data = error.find("data");
  if (data == error.end() || !data->is_object()) return fault;
  if (auto name = text_of(*data, "name"); !name.empty()) fault.name = std::move(name);
  if (auto state = text_of(*data, "state"); !state.empty()) fault.state = std::move(state);
  fault.where = text_of(*data, "where");
  fault.hint = text_of(*data, "hint");
  fault.id = text_of(*data, "id");
  const auto exit = data->find("exit");
  if (exit != data->end() && exit->is_number_unsigned() && *exit >= 1 && *exit <= 9) {
    fault.exit = exit->get<int>();
  }
  const auto generation = data->find("generation");
  if (generation != data->end() && generation->is_number_unsigned()) {
    fault.generation = generation->get<std::uint64_t>();
  }
  const auto errors = data->find("errors");
  if (errors != data->end() && errors->is_array()) fault.errors = *errors;
  return fault;
}

Error not_ours(std::string what) {
  return refuse({Errc::invalid_value, "not_mauved"}, {}, std::move(what),
                "is this really a mauved socket?");
}

}  // namespace

Fault fault_of(const Error& error, std::string state, std::optional<std::uint64_t> generation) {
  Fault fault;
  for (const auto& row : kOwnCodes) {
    if (row.errc != error.code) continue;
    fault.code = row.code;
    fault.exit = static_cast<int>(row.exit);
  }
  fault.name = to_string(error.code);
  fault.message = error.message;
  fault.where = error.at;
  fault.hint = error.hint;
  fault.id = error.id;
  fault.state = std::move(state);
  fault.generation = generation;
  if (fault.state == "safe") fault.exit = static_cast<int>(Exit::partly);
  return fault;
}

Fault fault_of(int code, std::string message, std::string where, std::string hint) {
  Fault fault;
  fault.code = code;
  for (const auto& row : kRpcCodes) {
    if (row.code != code) continue;
    fault.name = row.name;
    fault.exit = static_cast<int>(row.exit);
    fault.id = row.name;
  }
  fault.message = std::move(message);
  fault.where = std::move(where);
  fault.hint = std::move(hint);
  return fault;
}

Fault wrong_use(std::string id, std::string message, std::string where, std::string hint) {
  Fault fault = fault_of(kUsage, std::move(message), std::move(where), std::move(hint));
  fault.id = std::move(id);
  return fault;
}

std::optional<Errc> errc_named(std::string_view name) {
  for (const auto& row : kOwnCodes) {
    if (to_string(row.errc) == name) return row.errc;
  }
  return std::nullopt;
}

Error error_of(const Fault& fault) {
  return {errc_named(fault.name).value_or(Errc::invalid_value), fault.where, fault.message,
          fault.hint, fault.id};
}

std::variant<Request, Refusal> parse_request(std::string_view line) {
  auto parsed = parse_json(line, kMaxValues);
  if (!parsed) {
    const Error& error = parsed.error();
    return Refusal{nullptr, fault_of(kParseError, error.message, error.at, error.hint)};
  }
  Json& object = *parsed;
  if (auto wrong = envelope_fault(object); !wrong.empty()) {
    return Refusal{known_id(object),
                   fault_of(kInvalidRequest, std::move(wrong), {},
                            R"(example: {"jsonrpc":"2.0","id":1,"method":"status"})")};
  }
  Request request;
  request.id = std::move(object["id"]);
  request.method = object["method"].get<std::string>();
  request.params = take(object, "params", Json::object());
  if (!request.params.is_object()) {
    return Refusal{std::move(request.id), fault_of(kInvalidParams, "\"params\" must be an object",
                                                   request.method, "arguments have names")};
  }
  return request;
}

Json make_request(Json id, std::string_view method, Json params) {
  return {
      {"jsonrpc", "2.0"}, {"id", std::move(id)}, {"method", method}, {"params", std::move(params)}};
}

Json make_response(Json id, Json result) {
  return {{"jsonrpc", "2.0"}, {"id", std::move(id)}, {"result", std::move(result)}};
}

Json make_error(Json id, const Fault& fault) {
  return {{"jsonrpc", "2.0"}, {"id", std::move(id)}, {"error", to_json(fault)}};
}

Json make_notification(std::string_view method, Json params) {
  return {{"jsonrpc", "2.0"}, {"method", method}, {"params", std::move(params)}};
}

NotificationText::NotificationText(const Json& params) : members_(to_line(params)) {
  members_ = members_.substr(1, members_.size() - 2);
}

std::string NotificationText::line(std::string_view method, std::uint64_t sub) const {
  std::string text = R"({"jsonrpc":"2.0","method":")";
  text.append(method).append(R"(","params":{)").append(members_);
  if (!members_.empty()) text += ',';
  return text.append(R"("sub":)").append(std::to_string(sub)).append("}}\n");
}

Json to_json(const Fault& fault) {
  Json data = {{"name", fault.name},   {"exit", fault.exit}, {"state", fault.state},
               {"where", fault.where}, {"hint", fault.hint}, {"generation", nullptr}};
  if (!fault.id.empty()) data["id"] = fault.id;
  if (fault.generation) data["generation"] = *fault.generation;
  if (!fault.errors.is_null()) data["errors"] = fault.errors;
  return {{"code", fault.code}, {"message", fault.message}, {"data", std::move(data)}};
}

Result<ServerMessage> parse_server_message(std::string_view line) {
  auto parsed = parse_json(line);
  if (!parsed) return not_ours("the server sent something that is " + parsed.error().message);
  Json& object = *parsed;
  if (!object.is_object()) return not_ours("the server sent JSON that is not an object");
  if (auto method = text_of(object, "method"); !method.empty() && !object.contains("id")) {
    return ServerMessage{Notification{std::move(method), take(object, "params", Json::object())}};
  }
  const bool has_error = object.contains("error") && object["error"].is_object();
  if (!object.contains("id") || object.contains("result") == has_error) {
    return not_ours("the server sent an object that is neither answer nor notification");
  }
  if (has_error) {
    return ServerMessage{Response{std::move(object["id"]), fault_from_json(object["error"])}};
  }
  return ServerMessage{Response{std::move(object["id"]), std::move(object["result"])}};
}

}  // namespace mauve::protocol
