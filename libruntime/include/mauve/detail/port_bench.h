// SPDX-License-Identifier: LGPL-3.0-or-later
/// PortBench: the services of the ports of a shell under test, a part of the test kit.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <mauve/call_port.h>
#include <mauve/host/shared_data.h>
#include <mauve/host/value.h>
#include <mauve/port.h>
#include <mauve/shell.h>

namespace mauve {

/// Names and values, as text.
using BenchOutputs = std::vector<std::pair<std::string, std::string>>;

/// The far ends of all ports of one shell: a value to read, a place to write to, an answer to give.
class PortBench {
 public:
  /// Connects each port of plain data.
  explicit PortBench(Shell& shell) : shell_(shell) {
    for (PortBase* port : shell.ports()) {
      const Signature& signature = port->signature();
      ends_.emplace_back();
      if (signature.data == nullptr || !signature.data->flat) continue;
      ends_.back() = std::make_unique<SharedDataBase>(std::string(port->name()), *signature.data);
      static_cast<void>(port->connect(signature.kind == PortKind::read
                                          ? ends_.back()->read_service()
                                          : ends_.back()->write_service()));
    }
  }

  /// The port reads this value from now on; the value is written now.
  template <typename T>
  void give(const ReadPort<T>& port, const T& value) {
    ends_[port.index()]->write_service().write(&value);
  }
  /// Before configure: the port finds older values stale, as with `max_age` in a file.
  template <typename T>
  void max_age(ReadPort<T>& port, Duration age) {
    shell_.initial_bindings()[port.index()] = nullptr;
    static_cast<void>(port.connect(ends_[port.index()]->read_service(), age));
  }
  /// The last value that the core wrote; empty when it never did.
  template <typename T>
  [[nodiscard]] std::optional<T> written(const WritePort<T>& port) {
    T value{};
    return has_value(read_end(port.index(), &value)) ? std::optional<T>(value) : std::nullopt;
  }
  /// "ports.command" and the last value as text, of each write port with a described type.
  [[nodiscard]] BenchOutputs written() const {
    BenchOutputs all;
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      const Signature& signature = shell_.ports()[i]->signature();
      if (signature.kind != PortKind::write || ends_[i] == nullptr) continue;
      const DataType& type = *signature.data;
      if (type.to_value == nullptr) continue;
      std::vector<std::max_align_t> value(type.size / sizeof(std::max_align_t) + 1);
      type.construct(value.data());
      const bool there = has_value(read_end(i, value.data()));
      all.emplace_back("ports." + std::string(shell_.ports()[i]->name()),
                       there ? to_string(type.to_value(value.data())) : "not written");
    }
    return all;
  }
  /// Before configure: `function` answers the calls of this port.
  template <typename R, typename... P>
  void answer(CallPort<R(P...)>& port, std::function<R(P...)> function) {
    answers_.push_back(std::make_unique<Answer<R, P...>>(std::move(function)));
    static_cast<void>(port.connect(*answers_.back()));
  }

 private:
  DataStatus read_end(std::size_t index, void* value) const {
    ServiceBase& end = ends_[index]->read_service();
    Cursor cursor{end.attach(), 0, 0};
    const DataStatus status = end.read(value, cursor);
    end.detach(cursor.slot);
    return status;
  }
  static SharedDataBase& nowhere() {
    static SharedDataBase resource("test_kit", data_type<double>());
    return resource;
  }
  template <typename R, typename... P>
  class Answer final : public ServiceBase {
   public:
    explicit Answer(std::function<R(P...)> function)
        : ServiceBase(nowhere().interface(), "answer", Signature::call<R, P...>()),
          function_(std::move(function)) {}
    bool invoke(void* result, void* const* arguments) override {
      return call(result, arguments, std::index_sequence_for<P...>{});
    }

   private:
    template <std::size_t... I>
    bool call(void* result, void* const* arguments, std::index_sequence<I...>) {
      *static_cast<R*>(result) = function_(*static_cast<std::remove_cvref_t<P>*>(arguments[I])...);
      return true;
    }
    std::function<R(P...)> function_;
  };

  Shell& shell_;
  std::vector<std::unique_ptr<SharedDataBase>> ends_;  // by port index; null: not of this kind
  std::vector<std::unique_ptr<ServiceBase>> answers_;
};

}  // namespace mauve
