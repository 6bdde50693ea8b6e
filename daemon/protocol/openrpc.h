// SPDX-License-Identifier: LGPL-3.0-or-later
/// The table of methods as a document that programs read: https://spec.open-rpc.org, version 1.2.6.
/// Pure functions, any thread.
#pragma once

#include <span>

#include "protocol/methods.h"

namespace mauve::protocol {

/// An OpenRPC document of some methods, with the schemas to which they refer.
[[nodiscard]] Json openrpc_document(std::span<const Method> methods);

/// The JSON schema of a type. Records are references into "#/components/schemas/".
[[nodiscard]] Json schema_of(const Type& type);
/// The same with the text of the field and its unit as description.
[[nodiscard]] Json schema_of(const Field& field);
/// An object with these fields; further members are permitted, since later versions add some.
[[nodiscard]] Json schema_of(std::span<const Field> fields);

/// All records that the fields hold, directly or inside of other records, each once.
[[nodiscard]] std::vector<const Record*> records_in(std::span<const Field> fields);
/// All records that the methods answer, each once.
[[nodiscard]] std::vector<const Record*> records_in(std::span<const Method> methods);

}  // namespace mauve::protocol
