// SPDX-License-Identifier: LGPL-3.0-or-later
/// Part of the tests' precompiled headers: json_once.cpp compiles the functions of the JSON library
/// for all test programs, which takes a third off the time to compile them.
#pragma once

#include <nlohmann/json.hpp>

extern template class nlohmann::basic_json<>;
