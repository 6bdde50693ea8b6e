// SPDX-License-Identifier: LGPL-3.0-or-later
/// Requests, answers and notifications: the envelope, JSON-RPC 2.0. Pure functions, any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "mauve/result.h"
#include "protocol/framing.h"

namespace mauve::protocol {

inline constexpr int kVersion = 1;

/// Codes of JSON-RPC 2.0. Ours are -32010 and below, see fault_of().
inline constexpr int kParseError = -32700;
inline constexpr int kInvalidRequest = -32600;
inline constexpr int kUnknownMethod = -32601;
inline constexpr int kInvalidParams = -32602;
inline constexpr int kInternal = -32603;
/// Made by a client about itself, never sent: no daemon, a daemon that makes no sense, wrong use.
inline constexpr int kUnreachable = -32001;
inline constexpr int kBadAnswer = -32002;
inline constexpr int kUsage = -32003;

/// Exit codes of mauvectl, the same numbers as "exit" on the wire.
enum class Exit : int {
  ok = 0,
  refused = 1,    ///< refused or failed, nothing changed
  usage = 2,      ///< wrong use
  condition = 3,  ///< the condition asked for is false
  no_such_object = 4,
  permission = 5,
  conflict = 6,     ///< another generation, locked, busy
  unreachable = 7,  ///< no daemon
  timed_out = 8,    ///< outcome unknown
  partly = 9,       ///< done partly: not all obeyed in time, see status
};

/// All parts of an error on the wire: {"code","message","data":{...}}.
struct Fault {
  int code = kInternal;
  std::string name = "internal";    ///< one word, stable: "abi_mismatch"
  std::string message;              ///< one sentence
  int exit = 1;                     ///< see Exit
  std::string state = "unchanged";  ///< of the running system now
  std::string where;                ///< address, or file:line:column
  std::string hint;
  std::string id = {};  ///< name of its entry for `mauvectl explain`, may be empty
  std::optional<std::uint64_t> generation;  ///< the running one, where known
  /// Everything wrong in a file, else null: [{"line","column","at","code","message","hint"}].
  Json errors = nullptr;
};

/// The wire form of an Error. A state of "safe" makes the exit code 9.
[[nodiscard]] Fault fault_of(const Error& error, std::string state = "unchanged",
                             std::optional<std::uint64_t> generation = std::nullopt);
/// One of the codes above, with the name and exit code that belong to it.
[[nodiscard]] Fault fault_of(int code, std::string message, std::string where = {},
                             std::string hint = {});
/// kUsage: a wrong use of mauvectl, with the name of its entry in refusals.def.
[[nodiscard]] Fault wrong_use(std::string id, std::string message, std::string where = {},
                              std::string hint = {});
/// Back again: unknown names and JSON-RPC's own become invalid_value.
[[nodiscard]] Error error_of(const Fault& fault);
/// "unknown_name" -> Errc::unknown_name.
[[nodiscard]] std::optional<Errc> errc_named(std::string_view name);

struct Request {
  Json id;  ///< string or integer; send it back
  std::string method;
  Json params = Json::object();  ///< always an object
};

/// A line that is not a request: answer with make_error(id, fault). The id is null where unknown.
struct Refusal {
  Json id;
  Fault fault;
};

/// One line from a client. The arguments are not checked here, see check_params() in methods.h.
[[nodiscard]] std::variant<Request, Refusal> parse_request(std::string_view line);

[[nodiscard]] Json make_request(Json id, std::string_view method, Json params);
[[nodiscard]] Json make_response(Json id, Json result);
[[nodiscard]] Json make_error(Json id, const Fault& fault);
[[nodiscard]] Json make_notification(std::string_view method, Json params);

/// Parameters of a notification as text, so that many receivers share the work of writing them.
class NotificationText {
 public:
  /// `params` is an object without "sub".
  explicit NotificationText(const Json& params);
  /// The whole line for one subscription, with its end.
  [[nodiscard]] std::string line(std::string_view method, std::uint64_t sub) const;

 private:
  std::string members_;  ///< the object without its braces
};

/// The object under "error": {"code","message","data":{"name","exit","state","where",...}}.
[[nodiscard]] Json to_json(const Fault& fault);

struct Response {
  Json id;  ///< null: the server refuses the connection, not a request
  std::variant<Json, Fault> outcome;
};

struct Notification {
  std::string method;
  Json params = Json::object();
};

using ServerMessage = std::variant<Response, Notification>;

/// One line from the server. Members that this version does not know are ignored.
[[nodiscard]] Result<ServerMessage> parse_server_message(std::string_view line);

}  // namespace mauve::protocol
