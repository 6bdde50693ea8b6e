// SPDX-License-Identifier: LGPL-3.0-or-later
/// The table of methods, for people who write to the socket.
#include "protocol/methods.h"
#include "protocol/openrpc.h"
#include "render/render.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

using protocol::Field;
using protocol::Method;

std::string table_of(std::span<const Field> fields, const char* title, Look look) {
  Table table({{title}, {"TYPE"}, {"MEANING"}});
  for (const Field& field : fields) {
    table.add({{std::string(field.name)},
               {protocol::in_words(field.type) + (field.optional ? ", may be absent" : "")},
               {protocol::sentence_of(field)}});
  }
  return table.text(look.width, look.colour);
}

}  // namespace

std::string render_methods(Look look) {
  Table table({{"METHOD"}, {"ROLE", false, 1}, {"EFFECT", false, 2}, {"HELP"}});
  for (const Method& method : protocol::methods()) {
    table.add({{std::string(method.name)},
               {std::string(to_string(method.role))},
               {std::string(to_string(method.effect))},
               {std::string(method.help) + "."}});
  }
  return table.text(look.width, look.colour);
}

std::string render_method(const Method& method, Look look) {
  const std::string role(to_string(method.role));
  std::string text = painted(method.name, Paint::bold, look.colour) + "\n";
  text += wrapped(std::string(method.help) + ". The lowest role that may call it is " + role +
                      ". " + std::string(text_of(method.effect)) + ".",
                  look.width, 0) +
          "\n";
  const auto params = protocol::all_params(method);
  const auto answer = protocol::all_answer_fields(method);
  if (!params.empty()) text += "\n" + table_of(params, "PARAMETER", look);
  if (!answer.empty()) text += "\n" + table_of(answer, "ANSWER", look);
  for (const auto* record : protocol::records_in(answer)) {
    text +=
        "\n" +
        wrapped(std::string(record->name) + ": " + std::string(record->text) + ".", look.width, 0) +
        "\n" + table_of(record->fields, "FIELD", look);
  }
  return text;
}

}  // namespace mauve::ctl
