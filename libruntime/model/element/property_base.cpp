// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/detail/property_base.h>

namespace mauve {

PropertyBase::PropertyBase(Configurable& owner, std::string_view name, std::string_view text,
                           std::string_view unit, const DataType& type)
    : owner_(owner), name_(name), text_(text), unit_(unit), type_(&type) {
  owner.properties_.push_back(this);
}

std::string PropertyBase::address() const {
  return owner_.address().empty() ? std::string(name_)
                                  : owner_.address() + "." + std::string(name_);
}

Status PropertyBase::writable() const {
  if (!owner_.configured()) return ok();
  return refuse({Errc::wrong_state, "element_configured"}, address(),
                "cannot be written while its element is configured",
                "clean the element up first, or let the deployer swap it");
}

Status PropertyBase::set(const Value& value) {
  Status done = writable();
  if (done) done = assign(value);
  if (!done) {
    const std::string inner = done.error().at;
    if (inner.empty()) {
      done.error().at = address();
    } else if (inner.find(address()) != 0) {
      done.error().at = address() + "." + inner;
    }
  }
  return done;
}

void PropertyBase::defer(Error error) { owner_.pending_error_ = std::move(error); }

Error invalid(const PropertyBase& property, std::string message) {
  return refuse({Errc::invalid_value, "value_refused"}, property.address(), std::move(message),
                property.text().empty() ? "" : "it means: " + std::string(property.text()));
}

}  // namespace mauve
