// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/load.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "arch/build.h"
#include "arch/json.h"
#include "arch/parse.h"

namespace mauve::arch {

Result<std::string> read_file(const std::string& path) {
  std::error_code code;
  const auto kind = std::filesystem::status(path, code).type();
  if (kind == std::filesystem::file_type::not_found) {
    return refuse(Errc::unknown_name, path, "there is no such file");
  }
  if (!code && kind != std::filesystem::file_type::regular) {
    return refuse(Errc::invalid_value, path, "is not a regular file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) return refuse(Errc::system, path, std::strerror(errno));
  std::string text;
  text.resize(JsonLimits{}.bytes + 1);
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (file.bad()) return refuse(Errc::system, path, std::strerror(errno));
  if (text.size() > JsonLimits{}.bytes) {
    return refuse(Errc::limit, path,
                  "is longer than " + std::to_string(JsonLimits{}.bytes) + " bytes");
  }
  return text;
}

void load_plugins(const Spec& spec, plugin::Catalog& catalog, Problems& problems) {
  for (const PlacedText& plugin : spec.plugins) {
    if (catalog.find(plugin.value) != nullptr) continue;
    Status done = catalog.load(plugin.value);
    if (done) continue;
    done.error().at = "plugins." + plugin.value;
    problems.add(plugin.where, std::move(done.error()));
  }
}

std::unique_ptr<Architecture> load(std::string_view text, plugin::Catalog& catalog,
                                   Problems& problems, rules::Supervision* supervision) {
  const std::optional<Spec> spec = parse(text, problems);
  if (!spec) return nullptr;
  load_plugins(*spec, catalog, problems);
  return build(*spec, catalog, problems, supervision);
}

}  // namespace mauve::arch
