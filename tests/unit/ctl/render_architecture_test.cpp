// SPDX-License-Identifier: LGPL-3.0-or-later
// Architecture files as people read them.
#include "render/render.h"

#include <string>

#include <gtest/gtest.h>

namespace mauve::ctl {
namespace {

TEST(RenderArchitecture, WritesShortThingsInOneLine) {
  const Json architecture = Json::parse(R"({"name":"rover","components":{"laser":{"type":"a/b",
    "task":{"cpus":[1],"priority":60}}},"plugins":["types"],"resources":{}})");

  EXPECT_EQ(render_architecture(architecture),
            "{\n"
            "  \"name\": \"rover\",\n"
            "  \"plugins\": [\"types\"],\n"
            "  \"resources\": {},\n"
            "  \"components\": {\n"
            "    \"laser\": { \"type\": \"a/b\", \"task\": { \"priority\": 60, \"cpus\": [1] } }\n"
            "  }\n"
            "}\n");
}

TEST(RenderArchitecture, KeepsTheOrderPeopleWrite) {
  const Json architecture =
      Json::parse(R"({"components":{"laser":{"task":{"cpus":[1],"priority":60},
    "type":"drivers/laser"}},"name":"rover","schema":"mauve/architecture/1","plugins":[]})");

  EXPECT_EQ(architecture_line(architecture),
            R"({"schema":"mauve/architecture/1","name":"rover","plugins":[],"components":{"laser":)"
            R"({"type":"drivers/laser","task":{"priority":60,"cpus":[1]}}}})"
            "\n");
}

}  // namespace
}  // namespace mauve::ctl
