// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/message.h"

#include <string>

#include <gtest/gtest.h>

namespace mauve::protocol {
namespace {

constexpr Errc kAllErrc[] = {
    Errc::invalid_value, Errc::unknown_name,   Errc::duplicate,     Errc::type_mismatch,
    Errc::wrong_state,   Errc::hook_failed,    Errc::hook_threw,    Errc::cycle,
    Errc::abi_mismatch,  Errc::plugin_refused, Errc::not_permitted, Errc::conflict,
    Errc::timed_out,     Errc::limit,          Errc::unsupported,   Errc::system};

Refusal refusal_of(const std::string& line) {
  auto parsed = parse_request(line);
  if (auto* refusal = std::get_if<Refusal>(&parsed)) return std::move(*refusal);
  ADD_FAILURE() << "accepted: " << line;
  return {};
}

TEST(Request, IsReadWithItsArguments) {
  auto parsed =
      parse_request(R"({"jsonrpc":"2.0","id":7,"method":"param.get","params":{"address":"a.b"}})");

  const auto& request = std::get<Request>(parsed);
  EXPECT_EQ(request.id, 7);
  EXPECT_EQ(request.method, "param.get");
  EXPECT_EQ(request.params["address"], "a.b");
}

TEST(Request, MayHaveNoArgumentsAndATextAsId) {
  auto parsed = parse_request(R"({"jsonrpc":"2.0","id":"x","method":"ping"})");

  const auto& request = std::get<Request>(parsed);
  EXPECT_EQ(request.id, "x");
  EXPECT_TRUE(request.params.is_object());
}

TEST(Request, ThatIsNotJsonIsAParseErrorWithoutId) {
  const Refusal refusal = refusal_of(R"({"jsonrpc":"2.0","id":7,)");

  EXPECT_TRUE(refusal.id.is_null());
  EXPECT_EQ(refusal.fault.code, kParseError);
  EXPECT_EQ(refusal.fault.name, "parse_error");
  EXPECT_EQ(refusal.fault.exit, 2);
  EXPECT_FALSE(refusal.fault.where.empty());
}

TEST(Request, InABatchIsRefused) {
  const Refusal refusal = refusal_of(R"([{"jsonrpc":"2.0","id":1,"method":"ping"}])");

  EXPECT_EQ(refusal.fault.code, kInvalidRequest);
  EXPECT_NE(refusal.fault.message.find("batch"), std::string::npos);
}

TEST(Request, NeedsItsWholeEnvelope) {
  for (const char* line :
       {"1", "\"ping\"", "{}", R"({"id":1,"method":"ping"})",
        R"({"jsonrpc":"1.0","id":1,"method":"ping"})", R"({"jsonrpc":"2.0","method":"ping"})",
        R"({"jsonrpc":"2.0","id":null,"method":"ping"})",
        R"({"jsonrpc":"2.0","id":1.5,"method":"ping"})",
        R"({"jsonrpc":"2.0","id":[1],"method":"ping"})", R"({"jsonrpc":"2.0","id":1})",
        R"({"jsonrpc":"2.0","id":1,"method":2})", R"({"jsonrpc":"2.0","id":1,"method":""})",
        R"({"jsonrpc":"2.0","id":1,"method":"ping","extra":1})"}) {
    EXPECT_EQ(refusal_of(line).fault.code, kInvalidRequest) << line;
  }
}

TEST(Request, ThatIsRefusedKeepsItsIdWhereThereIsOne) {
  EXPECT_EQ(refusal_of(R"({"jsonrpc":"2.0","id":9})").id, 9);
  EXPECT_EQ(refusal_of(R"({"jsonrpc":"2.0","id":9,"method":"ping","params":[1]})").id, 9);
  EXPECT_TRUE(refusal_of(R"({"jsonrpc":"2.0","id":{},"method":"ping"})").id.is_null());
}

TEST(Request, WithUnnamedArgumentsIsRefused) {
  const Refusal refusal = refusal_of(R"({"jsonrpc":"2.0","id":9,"method":"ping","params":[1]})");

  EXPECT_EQ(refusal.fault.code, kInvalidParams);
}

TEST(Request, IsReadBackAsItWasMade) {
  const Json made = make_request(3, "port.disconnect", {{"port", "a.ports.b"}});

  auto parsed = parse_request(to_line(made));

  EXPECT_EQ(std::get<Request>(parsed).params, (Json{{"port", "a.ports.b"}}));
}

TEST(FaultOf, KeepsEveryErrorOverTheWire) {
  for (const Errc code : kAllErrc) {
    const Error error =
        refuse({code, "value_refused"}, "control.core.gain", "must be positive", "try 0.2");
    const std::string line = to_line(make_error(1, fault_of(error, "unchanged", 41)));

    const auto message = parse_server_message(line);

    ASSERT_TRUE(message) << line;
    const auto& fault = std::get<Fault>(std::get<Response>(*message).outcome);
    EXPECT_EQ(fault.name, to_string(code));
    EXPECT_EQ(fault.state, "unchanged");
    EXPECT_EQ(fault.generation, 41U);
    EXPECT_LE(fault.code, -32010);
    const Error back = error_of(fault);
    EXPECT_EQ(back.code, code);
    EXPECT_EQ(back.at, error.at);
    EXPECT_EQ(back.message, error.message);
    EXPECT_EQ(back.hint, error.hint);
    EXPECT_EQ(back.id, error.id);
  }
}

TEST(Fault, TakesAllErrorsOfAFileOverTheWire) {
  Fault fault = fault_of(refuse(Errc::invalid_value, "f.json", "the file has 1 error"));
  EXPECT_FALSE(to_json(fault)["data"].contains("errors")) << "other refusals say nothing of files";
  fault.errors = {{{"line", 3}, {"message", "must be positive"}}};

  const auto read = parse_server_message(to_line(make_error(7, fault)));

  ASSERT_TRUE(read);
  const auto& response = std::get<Response>(*read);
  EXPECT_EQ(std::get<Fault>(response.outcome).errors, fault.errors);
}

TEST(Fault, NamesNoEntryOnTheWireWhereItHasNone) {
  const Fault fault = fault_of(refuse(Errc::hook_failed, "a.core", "the lamp is broken"));

  EXPECT_FALSE(to_json(fault)["data"].contains("id"));
}

TEST(FaultOf, GivesEachCodeToOneErrorOnly) {
  std::vector<int> codes;
  for (const Errc code : kAllErrc) codes.push_back(fault_of(refuse(code, "", "")).code);
  std::sort(codes.begin(), codes.end());
  EXPECT_EQ(std::adjacent_find(codes.begin(), codes.end()), codes.end());
}

TEST(FaultOf, ChoosesTheExitCodeOfTheClient) {
  EXPECT_EQ(fault_of(refuse(Errc::invalid_value, "", "")).exit, 1);
  EXPECT_EQ(fault_of(refuse(Errc::unknown_name, "", "")).exit, 4);
  EXPECT_EQ(fault_of(refuse(Errc::not_permitted, "", "")).exit, 5);
  EXPECT_EQ(fault_of(refuse(Errc::conflict, "", "")).exit, 6);
  EXPECT_EQ(fault_of(refuse(Errc::timed_out, "", "")).exit, 8);
  EXPECT_EQ(fault_of(refuse(Errc::hook_failed, "", ""), "safe").exit, 9);
  EXPECT_EQ(fault_of(kUnknownMethod, "").exit, 2);
}

TEST(FaultOf, NamesTheEntryOfEachCodeOfTheProtocol) {
  EXPECT_EQ(fault_of(kParseError, "").id, "parse_error");
  EXPECT_EQ(fault_of(kInvalidParams, "").id, "invalid_params");
  EXPECT_EQ(fault_of(kUnreachable, "").id, "unreachable");
}

TEST(WrongUse, HasAnEntryOfItsOwn) {
  const Fault fault = wrong_use("usage_not_a_time", "'soon' is no time", "--for", "example: 10s");

  EXPECT_EQ(fault.name, "usage");
  EXPECT_EQ(fault.exit, 2);
  EXPECT_EQ(fault.state, "unchanged");
  EXPECT_EQ(fault.id, "usage_not_a_time");
  EXPECT_EQ(fault.where, "--for");
  EXPECT_EQ(fault.hint, "example: 10s");
}

TEST(ServerMessage, DistinguishesAnswersFromNotifications) {
  const auto answer = parse_server_message(to_line(make_response(5, {{"pong", true}})));
  const auto hello = parse_server_message(to_line(make_notification("hello", {{"role", "admin"}})));

  ASSERT_TRUE(answer);
  ASSERT_TRUE(hello);
  EXPECT_EQ(std::get<Response>(*answer).id, 5);
  EXPECT_EQ(std::get<Json>(std::get<Response>(*answer).outcome)["pong"], true);
  EXPECT_EQ(std::get<Notification>(*hello).method, "hello");
  EXPECT_EQ(std::get<Notification>(*hello).params["role"], "admin");
}

TEST(ServerMessage, IgnoresMembersItDoesNotKnow) {
  EXPECT_TRUE(parse_server_message(R"({"jsonrpc":"2.0","id":1,"result":{},"future":1})"));
}

TEST(ServerMessage, DoesNotTrustTheErrorOfAServer) {
  const auto message =
      parse_server_message(R"({"jsonrpc":"2.0","id":1,"error":{"code":"x","message":7,)"
                           R"("data":{"exit":300,"name":[],"generation":-1}}})");

  ASSERT_TRUE(message);
  const auto& fault = std::get<Fault>(std::get<Response>(*message).outcome);
  EXPECT_EQ(fault.exit, 1);
  EXPECT_EQ(fault.name, "internal");
  EXPECT_FALSE(fault.generation);
}

TEST(ServerMessage, RefusesWhatIsNeitherAnswerNorNotification) {
  for (const char* line : {"HTTP/1.1 400 Bad Request", "[]", "{}", R"({"id":1})",
                           R"({"id":1,"result":1,"error":{}})", R"({"id":1,"error":"no"})"}) {
    EXPECT_FALSE(parse_server_message(line)) << line;
  }
}

}  // namespace
}  // namespace mauve::protocol
