// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/openrpc.h"

#include <algorithm>
#include <string>
#include <utility>

#include "mauve/host/version.h"

namespace mauve::protocol {
namespace {

using Kind = Type::Kind;
using Shape = Type::Shape;

Json schema_of_kind(const Type& type) {
  switch (type.kind) {
    case Kind::text: {
      Json schema = {{"type", "string"}};
      if (!type.choices.empty()) schema["enum"] = choices_of(type);
      return schema;
    }
    case Kind::boolean:
      return {{"type", "boolean"}};
    case Kind::count:
      return {{"type", "integer"}, {"minimum", 0}};
    case Kind::integer:
      return {{"type", "integer"}};
    case Kind::number:
      return {{"anyOf", {{{"type", "number"}}, {{"enum", {"nan", "inf", "-inf"}}}}}};
    case Kind::duration:
      return {{"type", "string"}, {"pattern", "^-?[0-9]+(\\.[0-9]+)?(ns|us|ms|s|min|h)$"}};
    case Kind::time:
      return {{"type", "string"}, {"format", "date-time"}};
    case Kind::value:
      return Json::object();
    case Kind::object:
      return {{"type", "object"}};
    case Kind::record:
      return {{"$ref", "#/components/schemas/" + std::string(type.record->name)}};
  }
  return Json::object();
}

/// The meaning of a parameter or a field, with its unit.
std::string description_of(const Field& field) {
  std::string text = sentence_of(field);
  if (!field.type.unit.empty()) text += " Unit: " + std::string(field.type.unit) + ".";
  return text;
}

void add_records(std::span<const Field> fields, std::vector<const Record*>& all) {
  for (const Field& field : fields) {
    const Record* record = field.type.record;
    if (record == nullptr || std::ranges::find(all, record) != all.end()) continue;
    all.push_back(record);
    add_records(record->fields, all);
  }
}

/// A "Content Descriptor" of OpenRPC.
Json descriptor_of(const Field& param) {
  return {{"name", param.name},
          {"description", description_of(param)},
          {"required", !param.optional},
          {"schema", schema_of(param)}};
}

Json method_json(const Method& method) {
  Json params = Json::array();
  for (const Field& param : all_params(method)) params.push_back(descriptor_of(param));
  const std::string name(method.name);
  return {{"name", name},
          {"summary", std::string(method.help) + "."},
          {"description", std::string(text_of(method.effect)) +
                              ". The lowest role that may call it is " +
                              std::string(to_string(method.role)) + "."},
          {"paramStructure", "by-name"},
          {"params", std::move(params)},
          {"result",
           {{"name", "result"},
            {"description", "The answer of " + name + "."},
            {"schema", schema_of(all_answer_fields(method))}}},
          {"x-role", to_string(method.role)},
          {"x-lane", to_string(method.lane)},
          {"x-effect", to_string(method.effect)}};
}

}  // namespace

Json schema_of(const Type& type) {
  Json schema = schema_of_kind(type);
  if (type.shape == Shape::list) schema = {{"type", "array"}, {"items", std::move(schema)}};
  if (type.shape == Shape::map) {
    schema = {{"type", "object"}, {"additionalProperties", std::move(schema)}};
  }
  // The empty schema permits null already.
  if (!type.nullable || schema.empty()) return schema;
  return {{"anyOf", {std::move(schema), {{"type", "null"}}}}};
}

Json schema_of(const Field& field) {
  Json schema = schema_of(field.type);
  // A reader may ignore keys beside a reference.
  if (schema.contains("$ref")) schema = {{"allOf", Json::array({std::move(schema)})}};
  schema["description"] = description_of(field);
  return schema;
}

Json schema_of(std::span<const Field> fields) {
  Json properties = Json::object();
  Json required = Json::array();
  for (const Field& field : fields) {
    properties[std::string(field.name)] = schema_of(field);
    if (!field.optional) required.push_back(field.name);
  }
  Json schema = {{"type", "object"}, {"properties", std::move(properties)}};
  if (!required.empty()) schema["required"] = std::move(required);
  return schema;
}

std::vector<const Record*> records_in(std::span<const Field> fields) {
  std::vector<const Record*> all;
  add_records(fields, all);
  return all;
}

std::vector<const Record*> records_in(std::span<const Method> methods) {
  std::vector<const Record*> all;
  for (const Method& method : methods) {
    add_records(method.params, all);
    add_records(method.answer, all);
  }
  return all;
}

Json openrpc_document(std::span<const Method> methods) {
  Json rows = Json::array();
  for (const Method& method : methods) rows.push_back(method_json(method));
  Json schemas = Json::object();
  for (const Record* record : records_in(methods)) {
    Json schema = schema_of(record->fields);
    schema["description"] = std::string(record->text) + ".";
    schemas[std::string(record->name)] = std::move(schema);
  }
  return {{"openrpc", "1.2.6"},
          {"info",
           {{"title", "mauve"},
            {"version", std::to_string(kVersion)},
            {"description",
             "The protocol of mauved: JSON-RPC 2.0, one object a line, on a Unix socket."},
            {"license", {{"name", "LGPL-3.0-or-later"}}}}},
          {"methods", std::move(rows)},
          {"components", {{"schemas", std::move(schemas)}}}};
}

}  // namespace mauve::protocol
