// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/host/ring_buffer.h>

#include <cstring>

#include "model/element/state_transfer.h"

#include <mauve/core.h>
#include <mauve/detail/tap.h>
#include <mauve/job.h>
#include <mauve/observable.h>
#include <mauve/property.h>
#include <mauve/service.h>

namespace mauve {
namespace {

class RingBufferCore final : public CoreBase, public ValueStore {
 public:
  RingBufferCore(const DataType& data, std::shared_ptr<void> library)
      : data_(data), library_(std::move(library)) {}

  void push(const void* value, Instant stamp) {
    if (count_ == slots_) {
      first_ = (first_ + 1) % slots_;
      --count_;
      ++dropped_;
    }
    const std::size_t index = (first_ + count_) % slots_;
    std::memcpy(memory_.get() + index * data_.size, value, data_.size);
    stamps_[index] = stamp;
    ++count_;
    size_ = static_cast<std::int64_t>(count_);
  }
  bool pop(Visitor visitor, Instant& stamp) {
    if (count_ == 0) return false;
    visitor(memory_.get() + first_ * data_.size);
    stamp = stamps_[first_];
    first_ = (first_ + 1) % slots_;
    --count_;
    size_ = static_cast<std::int64_t>(count_);
    return true;
  }

  [[nodiscard]] std::size_t item_size() const { return data_.size; }

  [[nodiscard]] const DataType& data() const override { return data_; }
  void each(const Visit& visit) const override {
    for (std::size_t i = 0; i < count_; ++i) {
      const std::size_t index = (first_ + i) % slots_;
      visit(memory_.get() + index * data_.size, stamps_[index]);
    }
  }
  void put(const void* value, Instant stamp) override { push(value, stamp); }

 private:
  Status on_configure() override {
    slots_ = static_cast<std::size_t>(capacity_.get());
    memory_ = std::make_unique<std::byte[]>(slots_ * data_.size);
    stamps_ = std::make_unique<Instant[]>(slots_);
    first_ = count_ = 0;
    return ok();
  }

  const DataType& data_;
  std::shared_ptr<void> library_;  // of the data type
  Property<std::int64_t> capacity_{*this,
                                   "capacity",
                                   RingBufferBase::kCapacity,
                                   "items kept before the oldest is dropped",
                                   {.unit = "items", .min = 1, .max = 65536}};
  Observable<std::int64_t> dropped_{*this, "dropped", 0,
                                    "items dropped because the buffer was full"};
  Observable<std::int64_t> size_{*this, "size", 0, "items waiting to be read"};
  std::size_t slots_ = 0;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  std::unique_ptr<std::byte[]> memory_;
  std::unique_ptr<Instant[]> stamps_;
};

class Take final : public ServiceBase {
 public:
  Take(InterfaceBase& owner, const DataType& data, TapList& taps)
      : ServiceBase(owner, "read", {PortKind::read, data.name, data.layout, &data}), taps_(taps) {}

  [[nodiscard]] TapList* taps() override { return &taps_; }

  DataStatus read(void* into, Cursor& cursor) override {
    auto copy = [&](const void* data) { std::memcpy(into, data, ring().item_size()); };
    return look(Visitor(copy), cursor);
  }
  DataStatus look(Visitor visitor, Cursor& cursor) override {
    ScopedLock held(lock());
    if (!held) return held.refusal();
    return ring().pop(visitor, cursor.stamp) ? DataStatus::new_data : DataStatus::no_data;
  }

 private:
  RingBufferCore& ring() { return static_cast<RingBufferCore&>(core()); }

  TapList& taps_;
};

class Put final : public ServiceBase {
 public:
  Put(InterfaceBase& owner, const DataType& data, TapList& taps)
      : ServiceBase(owner, "write", {PortKind::write, data.name, data.layout, &data}),
        taps_(taps) {}

  [[nodiscard]] TapList* taps() override { return &taps_; }

  bool write(const void* data) override {
    ScopedLock held(lock());
    if (!held) return false;
    const Instant stamp = job_time();
    ring().push(data, stamp);
    taps_.push(data, stamp);
    return true;
  }

 private:
  RingBufferCore& ring() { return static_cast<RingBufferCore&>(core()); }

  TapList& taps_;
};

class RingBufferInterface final : public InterfaceBase {
 public:
  explicit RingBufferInterface(const DataType& data)
      : take_(*this, data, taps_), put_(*this, data, taps_) {}

 private:
  TapList taps_;  // survives an exchange of the core
  Take take_;
  Put put_;
};

ResourceType ring_buffer_type(const DataType& data, const std::shared_ptr<void>& library) {
  return {"ring_buffer", ShellType::of<EmptyShell>(),
          CoreType{"ring_buffer",
                   {},
                   [&data, library] { return std::make_shared<RingBufferCore>(data, library); }},
          [&data] { return std::make_shared<RingBufferInterface>(data); }};
}

}  // namespace

RingBufferBase::RingBufferBase(std::string name, const DataType& data,
                               std::shared_ptr<void> library)
    : ResourceBase(std::move(name), ring_buffer_type(data, library)) {
  lock().blame_caller();
}

}  // namespace mauve
