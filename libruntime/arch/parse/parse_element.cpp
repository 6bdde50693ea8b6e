// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/parse/parse_element.h"

#include <algorithm>
#include <utility>

#include "base/address.h"

namespace mauve::arch {
namespace {

void read_properties(const Source& source, const std::vector<std::string>& groups,
                     std::vector<PropertySpec>& into) {
  read_members(source, [&](const Member& member, const Source& inner) {
    // "core.gain" of "control" has the address control.core.gain; "properties" is no part of it.
    const std::string element = source.at.substr(0, source.at.rfind('.'));
    const Source property{inner.node, element + "." + member.key.substr(0, kLongestAddress),
                          inner.problems};
    const Result<Address> address = Address::parse(member.key);
    const bool grouped =
        address && address->size() == 2 &&
        std::find(groups.begin(), groups.end(), address->element()) != groups.end();
    if (!grouped) {
      property.problems.add(member.where, {Errc::invalid_value, "file_value_invalid"}, property.at,
                            "not the name of a property",
                            "write the part and the name, such as \"core.gain\"; " +
                                nearest_hint(member.key.substr(0, member.key.find('.')), groups));
      return;
    }
    if (property.node.get_if<std::monostate>() != nullptr) return property.refuse("has no value");
    into.push_back({member.key, to_value(property.node), member.where, property.node.where});
  });
}

void read_service(const Source& source, ConnectionSpec& connection) {
  const std::optional<std::string> text = read_text(source);
  if (!text) return;
  const Result<Address> address = Address::parse(*text);
  if (!address || address->size() != 2) {
    return source.refuse("\"" + text->substr(0, kLongestName) + "\" is not a service",
                         "write the resource and its service, such as \"scan.read\"");
  }
  connection.service = *text;
  connection.service_where = source.node.where;
}

void read_connection(const Member& member, const Source& source,
                     std::vector<ConnectionSpec>& into) {
  if (!good_key(member, source)) return;
  ConnectionSpec connection{member.key, {}, {}, member.where, source.node.where};
  if (source.node.get_if<std::string>() != nullptr) {
    read_service(source, connection);
  } else if (source.node.get_if<Node::Object>() != nullptr) {
    bool named = false;
    read_object(source, {{"connect",
                          [&](const Source& value) {
                            named = true;
                            read_service(value, connection);
                          }},
                         {"max_age", [&](const Source& value) {
                            connection.max_age = read_duration(value);
                            if (connection.max_age == Duration{0}) value.refuse("must be over 0");
                          }}});
    if (!named)
      source.refuse("\"connect\" is missing", "write \"connect\": \"resource.service\"",
                    {Errc::invalid_value, "file_key_missing"});
  } else {
    source.refuse_kind("\"resource.service\" or an object",
                       "write \"" + member.key + "\": \"resource.service\"");
  }
  if (!connection.service.empty()) into.push_back(std::move(connection));
}

}  // namespace

std::optional<PlacedText> read_name(const Source& source, bool (*valid)(std::string_view),
                                    std::string_view hint) {
  std::optional<std::string> text = read_text(source);
  if (!text) return std::nullopt;
  if (!valid(*text)) {
    source.refuse("\"" + text->substr(0, kLongestName) + "\" is not a valid name here",
                  std::string(hint));
    return std::nullopt;
  }
  return PlacedText{*std::move(text), source.node.where};
}

std::optional<PlacedText> read_type(const Source& source) {
  return read_name(source, is_type_name,
                   "write \"plugin/name\", or a built-in: shared_data, ring_buffer");
}

bool good_key(const Member& member, const Source& source) {
  Status named = check_name(member.key, source.at);
  if (named) return true;
  source.problems.add(member.where, std::move(named.error()));
  return false;
}

Field type_field(ElementSpec& element) {
  return {"type", [&](const Source& source) {
            if (auto type = read_type(source)) element.type = *std::move(type);
          }};
}

Field type_name_field(std::string_view key, std::optional<PlacedText>& into) {
  return {key, [&into](const Source& source) {
            if (auto text = read_type(source)) into = std::move(text);
          }};
}

Field properties_field(ElementSpec& element, std::vector<std::string> groups) {
  return {"properties", [&element, groups = std::move(groups)](const Source& source) {
            read_properties(source, groups, element.properties);
          }};
}

Field ports_field(ElementSpec& element) {
  return {"ports", [&](const Source& source) {
            read_members(source, [&](const Member& member, const Source& port) {
              read_connection(member, port, element.connections);
            });
          }};
}

Field fallback_field(std::optional<FallbackSpec>& into) {
  return {"fallback_core", [&into](const Source& source) {
            FallbackSpec& fallback = into.emplace();
            const auto read_core = [&fallback](const Source& value) {
              if (auto core = read_type(value)) fallback.core = *std::move(core);
            };
            if (source.node.get_if<Node::Object>() == nullptr) return read_core(source);
            const auto* members = read_object(
                source, {{"core", read_core}, {"properties", [&fallback](const Source& value) {
                                                 read_properties(value, {"core"},
                                                                 fallback.properties);
                                               }}});
            require_key(source, *members, "core", "\"core\": \"plugin/name\"");
          }};
}

void require_type(const Source& source, const ElementSpec& element) {
  const auto* members = source.node.get_if<Node::Object>();
  if (members == nullptr) return;
  const bool named = std::any_of(members->begin(), members->end(),
                                 [](const Member& member) { return member.key == "type"; });
  if (!named) {
    source.problems.add(element.where, {Errc::invalid_value, "file_key_missing"}, element.name,
                        "\"type\" is missing", "write \"type\": \"plugin/name\"");
  }
}

}  // namespace mauve::arch
