// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/methods.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "protocol/openrpc.h"
#include "protocol/row.h"

namespace mauve::protocol {
namespace {

std::optional<Fault> check(std::string_view method, const Json& params) {
  const Method* found = find_method(method);
  EXPECT_NE(found, nullptr) << method;
  return check_params(*found, params);
}

TEST(Methods, HaveOneNameEach) {
  std::set<std::string_view> names;
  for (const Method& method : methods()) EXPECT_TRUE(names.insert(method.name).second);
}

TEST(Methods, AreFoundByNameAndAlias) {
  ASSERT_NE(find_method("status"), nullptr);
  EXPECT_EQ(find_method("status")->name, "status.get");
  EXPECT_EQ(find_method("nothing"), nullptr);
}

TEST(Methods, ServeOnlyPingAndStopOutOfBand) {
  for (const Method& method : methods()) {
    EXPECT_EQ(method.out_of_band(), method.name == "ping" || method.name == "component.stop");
  }
}

std::string text_of(std::size_t characters) {
  std::string text;
  for (std::size_t i = 0; i < characters; ++i) text += "\xC3\xA9";  // é is one character
  return text;
}

TEST(CheckParams, RefusesATextThatIsLongerThanAnyNameInOneSentence) {
  EXPECT_FALSE(check("param.get", {{"address", text_of(500)}}));

  const auto fault = check("param.get", {{"address", text_of(501)}});

  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->code, kInvalidParams);
  EXPECT_EQ(fault->message,
            "argument 'address' has a text of 501 characters, and at most 500 are read");
}

/// So many items of this type, which is a list or a map.
Json items_of(const Type& type, std::size_t count) {
  const bool map = type.shape == Type::Shape::map;
  Json items = map ? Json::object() : Json::array();
  for (std::size_t i = 0; i < count; ++i) {
    const Json item = type.kind == Type::Kind::object ? Json::object() : Json(std::to_string(i));
    if (map) items[std::to_string(i)] = item;
    if (!map) items.push_back(item);
  }
  return items;
}

TEST(CheckParams, HasAGreatestNumberOfItemsForEachListAndMapOfEachMethod) {
  int tried = 0;
  for (const Method& method : methods()) {
    for (const Field& param : all_params(method)) {
      const Json value = items_of(param.type, 1025);
      if (param.type.shape == Type::Shape::one || !fits(value, param.type)) continue;
      ++tried;
      const auto fault = check_params(method, {{std::string(param.name), value}});
      ASSERT_TRUE(fault) << method.name << " " << param.name;
      EXPECT_NE(fault->message.find("has 1025 items, and at most 1024 are read"), std::string::npos)
          << method.name << ": " << fault->message;
    }
  }
  EXPECT_GT(tried, 4) << "lists and maps of names and values";
}

/// A value of this type whose text has so many characters; null: it has no text.
Json long_value(const Type& type, std::size_t characters) {
  if (!type.choices.empty()) return nullptr;
  if (type.shape == Type::Shape::map) return Json{{text_of(characters), 1}};
  const bool texts = type.kind == Type::Kind::text || type.kind == Type::Kind::duration ||
                     type.kind == Type::Kind::time;
  if (!texts) return nullptr;
  return type.shape == Type::Shape::list ? Json{text_of(1), text_of(characters)}
                                         : Json(text_of(characters));
}

TEST(CheckParams, HasAGreatestLengthForEachTextOfEachMethod) {
  int tried = 0;
  for (const Method& method : methods()) {
    for (const Field& param : all_params(method)) {
      const Json value = long_value(param.type, 5'000);
      if (value.is_null() || param.name == "text") continue;
      ++tried;
      const auto fault = check_params(method, {{std::string(param.name), value}});
      ASSERT_TRUE(fault) << method.name << " " << param.name;
      EXPECT_NE(fault->message.find("5000 characters"), std::string::npos)
          << method.name << ": " << fault->message;
    }
  }
  EXPECT_GT(tried, 10) << "names, addresses, reasons";
}

TEST(CheckParams, LetsFilesReasonsAndConditionsBeLongerThanNames) {
  EXPECT_FALSE(check("config.check", {{"text", std::string(900'000, ' ')}}));
  EXPECT_FALSE(check("config.check", {{"text", "{}"}, {"file", text_of(4'000)}}));
  EXPECT_FALSE(check("condition.get", {{"condition", text_of(1'001)}})) << "its reader refuses it";
  EXPECT_FALSE(check("component.stop", {{"all", true}, {"reason", text_of(1'000)}}));
  EXPECT_TRUE(check("component.stop", {{"all", true}, {"reason", text_of(1'001)}}));
}

/// One sentence that begins with a capital letter; readers add the full stop.
void expect_sentence(std::string_view text, std::string_view of) {
  ASSERT_GE(text.size(), 4U) << of << " has no text";
  EXPECT_TRUE(text.front() >= 'A' && text.front() <= 'Z') << of << ": " << text;
  EXPECT_NE(text.back(), '.') << of << ": " << text;
  EXPECT_EQ(text.find("  "), std::string_view::npos) << of << ": " << text;
}

void expect_described(std::span<const Field> fields, std::string_view of) {
  std::set<std::string_view> names;
  for (const Field& field : fields) {
    const std::string at = std::string(of) + "." + std::string(field.name);
    EXPECT_FALSE(field.name.empty()) << of;
    EXPECT_TRUE(names.insert(field.name).second) << at << " stands there twice";
    expect_sentence(field.text, at);
    EXPECT_EQ(field.type.kind == Type::Kind::record, field.type.record != nullptr) << at;
  }
}

TEST(Methods, HaveHelpAndFieldsInTheirAnswers) {
  for (const Method& method : methods()) {
    expect_sentence(method.help, method.name);
    EXPECT_FALSE(method.answer.empty()) << method.name << " names no field of its answer";
    expect_described(all_params(method), method.name);
    expect_described(all_answer_fields(method), method.name);
    EXPECT_NE(method.role, Role::none) << method.name;
  }
}

TEST(Methods, HaveRecordsWithOneNameEachAndFields) {
  std::set<std::string_view> names;
  for (const Record* record : records_in(methods())) {
    EXPECT_TRUE(names.insert(record->name).second) << record->name;
    expect_sentence(record->text, record->name);
    EXPECT_FALSE(record->fields.empty()) << record->name;
    expect_described(record->fields, record->name);
  }
  EXPECT_GT(names.size(), 30U);
}

TEST(Methods, NameTheUnitInFieldsThatEndWithOne) {
  const auto check = [](std::span<const Field> fields, std::string_view of) {
    for (const Field& field : fields) {
      const bool ns = field.name.ends_with("_ns");
      EXPECT_EQ(ns, field.type.unit == "ns") << of << "." << field.name;
      if (field.name.ends_with("_s")) {
        EXPECT_EQ(field.type.unit, "s") << of << "." << field.name;
      }
      if (field.name.ends_with("bytes")) {
        EXPECT_EQ(field.type.unit, "bytes") << of << "." << field.name;
      }
    }
  };
  for (const Record* record : records_in(methods())) check(record->fields, record->name);
  check(find_method("status.get")->answer, "status.get");
  check(find_method("param.get")->answer, "param.get");
}

TEST(Methods, ThatOnlyReadAreForViewers) {
  for (const Method& method : methods()) {
    const bool reads = method.effect == Effect::reads || method.effect == Effect::out_of_band;
    EXPECT_EQ(reads, method.role == Role::viewer) << method.name;
  }
}

TEST(Methods, HaveEffectsWithWordsAndSentences) {
  std::set<std::string_view> words;
  for (const Effect effect : effects()) {
    EXPECT_TRUE(words.insert(to_string(effect)).second);
    expect_sentence(text_of(effect), to_string(effect));
  }
  EXPECT_EQ(words.size(), 7U);
  EXPECT_EQ(to_string(Effect::stops), "stops");
  EXPECT_EQ(to_string(Lane::change), "change");
}

TEST(Types, AreNamedInWords) {
  EXPECT_EQ(in_words(row::or_null(row::ns)), "integer in ns or null");
  EXPECT_EQ(in_words(row::list(row::text)), "list of text");
  EXPECT_EQ(in_words(row::map(row::value)), "map of value");
  EXPECT_EQ(sentence_of(row::may("sync", row::one_of("cut barrier"), "The way")),
            "The way. One of: cut, barrier.");
}

TEST(Types, FitValuesOfTheirJsonTypeOnly) {
  EXPECT_TRUE(fits(nullptr, row::or_null(row::count)));
  EXPECT_FALSE(fits(nullptr, row::count));
  EXPECT_TRUE(fits(-1, row::integer));
  EXPECT_FALSE(fits(-1, row::count));
  EXPECT_TRUE(fits("nan", row::number));
  EXPECT_FALSE(fits("four", row::number));
  EXPECT_TRUE(fits({{"a", 1}}, row::map(row::count)));
  EXPECT_FALSE(fits({{"a", "b"}}, row::map(row::count)));
  EXPECT_FALSE(fits({1, nullptr}, row::list(row::count)));
  EXPECT_TRUE(fits("cut", row::one_of("cut barrier")));
  EXPECT_FALSE(fits("cu", row::one_of("cut barrier")));
}

TEST(UnknownMethod, NamesTheNearest) {
  const Fault fault = unknown_method("core.swpa");

  EXPECT_EQ(fault.code, kUnknownMethod);
  EXPECT_EQ(fault.hint, "did you mean 'core.swap'?");
  EXPECT_FALSE(unknown_method("frobnicate").hint.empty());
}

TEST(CheckParams, AcceptsWhatTheTableSays) {
  EXPECT_FALSE(check("ping", Json::object()));
  EXPECT_FALSE(check("core.swap", {{"component", "a"}, {"core", "b/c"}, {"set", {{"k", 1}}}}));
  EXPECT_FALSE(check("component.stop", {{"all", true}}));
  EXPECT_FALSE(check("watch.subscribe", {{"addresses", {"a.read", "b.read"}}}));
}

TEST(CheckParams, AcceptsTheArgumentsOfEveryMutation) {
  const Json params = {
      {"port", "a.ports.b"}, {"if_generation", 3}, {"reason", "test"}, {"deadline_ms", 100}};

  EXPECT_FALSE(check("port.disconnect", params));
  EXPECT_TRUE(check("param.get", {{"address", "a"}, {"if_generation", 3}}));
}

TEST(CheckParams, RefusesAnUnknownArgumentWithTheNearestName) {
  const auto fault = check("core.swap", {{"component", "a"}, {"core", "b"}, {"inplace", true}});

  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->code, kInvalidParams);
  EXPECT_EQ(fault->where, "core.swap");
  EXPECT_EQ(fault->hint, "did you mean 'in_place'?");
}

TEST(CheckParams, RefusesAMissingArgument) {
  const auto fault = check("port.connect", {{"port", "a.ports.b"}});

  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->message, "argument 'service' is missing");
}

TEST(CheckParams, RefusesAWordThatIsNoChoice) {
  const auto fault = check("lock.set", {{"lock", "some"}});

  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->code, kInvalidParams);
  EXPECT_EQ(fault->message, "argument 'lock' must be one of none, params, topology, all");
  EXPECT_FALSE(check("lock.set", {{"lock", "topology"}}));
}

TEST(CheckParams, RefusesAnotherJsonType) {
  EXPECT_TRUE(check("param.get", {{"address", 1}}));
  EXPECT_TRUE(check("component.stop", {{"all", "yes"}}));
  EXPECT_TRUE(check("watch.unsubscribe", {{"sub", -1}}));
  EXPECT_TRUE(check("watch.unsubscribe", {{"sub", 1.5}}));
  EXPECT_TRUE(check("param.set", {{"values", Json::array()}}));
  EXPECT_TRUE(check("watch.subscribe", {{"addresses", {"a", 1}}}));
  EXPECT_TRUE(check("watch.subscribe", {{"addresses", nullptr}}));
}

}  // namespace
}  // namespace mauve::protocol
