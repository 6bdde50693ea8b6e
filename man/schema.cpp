// SPDX-License-Identifier: LGPL-3.0-or-later
#include "schema.h"

#include <algorithm>
#include <vector>

#include "protocol/framing.h"
#include "render/words.h"
#include "roff.h"

namespace mauve::man {
namespace {

using protocol::Json;

using ctl::join;
using ctl::member;
using ctl::text_in;

/// "#/definitions/duration" is "duration".
std::string reference(const Json& schema) {
  const std::string path = text_in(schema, "$ref");
  return path.substr(path.rfind('/') + 1);
}

std::string joined(const std::vector<std::string>& words, const char* last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? last : ", ";
    text += words[i];
  }
  return text;
}

/// The values that the schema permits: "duration", "array of name", "\"stop\" or \"fallback\"".
std::string kind_of(const Json& schema) {
  if (const std::string name = reference(schema); !name.empty()) return italic(name);
  std::vector<std::string> words;
  for (const Json& one : member(schema, "enum")) words.push_back(bold(one.dump()));
  for (const Json& one : member(schema, "oneOf")) words.push_back(kind_of(one));
  if (const Json& only = member(schema, "const"); !only.is_null()) {
    words.push_back(bold(only.dump()));
  }
  if (!words.empty() && text_in(schema, "type") != "object") return joined(words, " or ");
  const std::string type = text_in(schema, "type");
  if (type == "array") return "array of " + kind_of(member(schema, "items"));
  if (type == "object") {
    const std::string inside = kind_of(member(schema, "additionalProperties"));
    return inside.empty() ? "object" : "object of " + inside;
  }
  // "not null" is all that a schema can state about the value of a property.
  return type.empty() && !member(schema, "not").is_null() ? "value" : type;
}

std::string sentence(std::string text) {
  if (!text.empty() && text.back() != '.') text += '.';
  return text;
}

std::string limits_of(const Json& schema) {
  std::string text;
  const auto add = [&](const char* key, const std::string& words) {
    const Json& value = member(schema, key);
    if (!value.is_null()) join(text, words + value.dump());
  };
  add("minimum", "at least ");
  add("maximum", "at most ");
  add("default", "default ");
  if (!text.empty()) text.front() = text.front() == 'd' ? 'D' : 'A';
  return sentence(text);
}

std::string examples_of(const Json& schema) {
  std::vector<std::string> words;
  for (const Json& one : member(schema, "examples")) words.push_back(bold(one.dump()));
  return words.empty() ? "" : "Example: " + joined(words, ", ") + ".";
}

std::string form_of(const Json& schema) {
  const std::string pattern = text_in(schema, "pattern");
  return pattern.empty() ? "" : "Form: " + bold(pattern) + ".";
}

/// Description, limits, examples, in so many lines as there are.
std::string about(const Json& schema) {
  std::string text;
  for (const std::string& line : {inline_roff(sentence(text_in(schema, "description"))),
                                  plain(limits_of(schema)), examples_of(schema), form_of(schema)}) {
    if (!line.empty()) text += (text.empty() ? "" : "\n") + line;
  }
  return text;
}

std::string heading(std::string_view name, const Json& schema) {
  const std::string text = about(schema);
  return ".SS " + plain(name) + "\n" + (text.empty() ? "" : text + "\n");
}

bool is_required(const Json& object, const std::string& key) {
  const Json& all = member(object, "required");
  return std::find(all.begin(), all.end(), key) != all.end();
}

/// Those that must be there, then the others.
std::string keys_of(const Json& object) {
  std::string first;
  std::string others;
  for (const auto& [key, schema] : member(object, "properties").items()) {
    const bool required = is_required(object, key);
    const std::string tag = bold(key) + " (" + kind_of(schema) + (required ? ", required)" : ")");
    (required ? first : others) += item(tag, about(schema));
  }
  return first + others;
}

/// The keys of an object, of the objects in an array, or of each of several forms.
std::string all_keys_of(const Json& schema) {
  std::string text = keys_of(schema);
  for (const Json& form : member(schema, "oneOf")) text += keys_of(form);
  const Json& items = member(schema, "items");
  return items.is_object() ? text + all_keys_of(items) : text;
}

}  // namespace

std::string schema_keys(std::string_view schema) {
  const Json root = Json::parse(schema, nullptr, false);
  if (member(root, "properties").empty()) return {};
  std::string text = heading("The file", root) + keys_of(root);
  std::string kinds;
  for (const auto& [name, definition] : member(root, "definitions").items()) {
    const std::string keys = all_keys_of(definition);
    if (!keys.empty()) {
      text += heading(name, definition) + keys;
    } else {
      const std::string its = about(definition);
      kinds += item(bold(name) + " (" + kind_of(definition) + ")", its);
    }
  }
  return text + ".SS Kinds of values\n" + kinds;
}

}  // namespace mauve::man
