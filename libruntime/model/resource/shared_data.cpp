// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/host/shared_data.h>

#include <cstring>

#include <mauve/core.h>
#include <mauve/detail/exchange.h>
#include <mauve/job.h>
#include <mauve/service.h>
#include <mauve/state.h>

#include "model/element/state_transfer.h"

namespace mauve {

namespace {

unsigned places_for(const DataType& data) {
  const bool large = data.size > SharedDataBase::kLarge;
  return large ? SharedDataBase::kReadersOfLarge : SharedDataBase::kReaders;
}

/// The exchange lives in the core: it is the inner data of the resource.
class SharedDataCore final : public CoreBase, public ValueStore {
 public:
  SharedDataCore(const DataType& data, std::shared_ptr<void> library)
      : data_(data), library_(std::move(library)), exchange_(data.size, places_for(data)) {}

  [[nodiscard]] const DataType& data() const override { return data_; }
  void each(const Visit& visit) const override {
    const LatestValue::View newest = exchange_.latest.newest();
    if (newest.data != nullptr) visit(newest.data, newest.header.stamp);
  }
  void put(const void* value, Instant stamp) override {
    std::memcpy(exchange_.latest.begin_write(), value, data_.size);
    exchange_.latest.end_write(stamp);
  }

  const DataType& data_;
  std::shared_ptr<void> library_;  // of the data type
  Exchange exchange_;
  Stateless stateless_{*this};
};

Signature data_signature(PortKind kind, const DataType& data) {
  return {kind, data.name, data.layout, &data};
}

/// Its core has no properties: it is never exchanged.
Exchange& exchange_of(const InterfaceBase& interface) {
  return static_cast<SharedDataCore&>(interface.core()).exchange_;
}

/// Readers with a slot of their own never wait; the others take turns under the lock.
class ReadLatest final : public ServiceBase {
 public:
  ReadLatest(InterfaceBase& owner, const DataType& data)
      : ServiceBase(owner, "read", data_signature(PortKind::read, data)) {}

  unsigned attach() override { return latest().attach(); }
  void detach(unsigned slot) override { latest().detach(slot); }
  [[nodiscard]] TapList* taps() override { return &exchange()->taps; }
  [[nodiscard]] Exchange* exchange() override { return &exchange_of(owner()); }

  DataStatus read(void* into, Cursor& cursor) override {
    auto copy = [&](const void* data) { std::memcpy(into, data, latest().size()); };
    return look(Visitor(copy), cursor);
  }
  DataStatus look(Visitor visitor, Cursor& cursor) override {
    if (cursor.slot != LatestValue::kNoSlot) return show(latest().seek(cursor), visitor, cursor);
    ScopedLock held(lock());
    if (!held) return held.refusal();
    const LatestValue::View view = latest().acquire(LatestValue::kInTurn);
    return show(LatestValue::show(view, cursor), visitor, cursor);
  }

 private:
  static DataStatus show(DataStatus status, const Visitor& visitor, Cursor& cursor) {
    if (status == DataStatus::no_data) return status;
    const void* const data = cursor.data;
    const std::uint64_t seen = cursor.seen;
    const bool fresh = status == DataStatus::new_data;
    if (fresh) {  // a caller that throws has not seen it
      cursor.word = Cursor::kNone;
      cursor.seen = 0;
    }
    visitor(data);
    // The visitor may have read on, and an abandoned thread has a replacement that does.
    const bool still = cursor.seen == 0 && !this_job().has_no_ports();
    if (fresh && still) cursor.seen = seen;
    return status;
  }
  LatestValue& latest() { return exchange_of(owner()).latest; }
};

/// The port that came first writes without a call and without the lock, which it acquires to notify
/// taps. Others write under it, as does a port that fills a value in place.
class WriteLatest final : public ServiceBase {
 public:
  WriteLatest(InterfaceBase& owner, const DataType& data)
      : ServiceBase(owner, "write", data_signature(PortKind::write, data)) {}

  [[nodiscard]] TapList* taps() override { return &exchange()->taps; }
  [[nodiscard]] Exchange* exchange() override { return &exchange_of(owner()); }

  bool write(const void* data) override {
    auto copy = [&](void* into) { std::memcpy(into, data, exchange()->latest.size()); };
    return fill(Filler(copy));
  }
  bool fill(Filler filler) override {
    ScopedLock held(lock());
    if (!held) return false;
    const Instant stamp = job_time();
    Exchange& into = *exchange();
    void* const value = into.latest.begin_write();
    filler(value);
    // A thread that was abandoned in there does not overtake its safe value.
    const Job& job = this_job();
    if (job.running && job.has_no_ports()) return false;
    into.latest.end_write(stamp);
    into.taps.push(value, stamp);
    return true;
  }
};

class SharedDataInterface final : public InterfaceBase {
 public:
  explicit SharedDataInterface(const DataType& data) : read_(*this, data), write_(*this, data) {}

 private:
  ReadLatest read_;
  WriteLatest write_;
};

ResourceType shared_data_type(const DataType& data, const std::shared_ptr<void>& library) {
  return {"shared_data", ShellType::of<EmptyShell>(),
          CoreType{"shared_data",
                   {},
                   [&data, library] { return std::make_shared<SharedDataCore>(data, library); }},
          [&data] { return std::make_shared<SharedDataInterface>(data); }};
}

}  // namespace

SharedDataBase::SharedDataBase(std::string name, const DataType& data, const void* initial,
                               std::shared_ptr<void> library)
    : ResourceBase(std::move(name), shared_data_type(data, library)) {
  lock().hold_shortly();
  lock().blame_caller();
  if (made() && initial != nullptr) write_service().write(initial);
}

}  // namespace mauve
