// SPDX-License-Identifier: Apache-2.0
// An array of plain values that several workers may write to at once, each through a view of its own, as long as no two touch the same element: it never
// moves while views are in use, and a view can't make it move.
#pragma once

#include <algorithm>
#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>

#include "core/check.hpp"
#include "core/page_memory.hpp"

namespace wellmesh {

/// Grows like a std::vector, but new elements are left as they are in memory unless a value is given, so that whoever fills them touches them first.
template <class T>
class SharedArray {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

public:
    SharedArray() = default;
    SharedArray(const SharedArray& other) { *this = other; }
    SharedArray(SharedArray&& other) noexcept { swap(other); }
    ~SharedArray() { give_back(); }
    /// A copy owns its elements, also that of a view.
    SharedArray& operator=(const SharedArray& other) {
        if (this == &other) return *this;
        clear();
        resize_as_is(other.size_);
        std::copy_n(other.data_, other.size_, data_);
        return *this;
    }
    SharedArray& operator=(SharedArray&& other) noexcept {
        swap(other);
        return *this;
    }
    void swap(SharedArray& other) noexcept {
        std::swap(data_, other.data_);
        std::swap(size_, other.size_);
        std::swap(ready_, other.ready_);
        std::swap(capacity_, other.capacity_);
        std::swap(owns_, other.owns_);
    }

    /// The same elements. Valid until this array grows or goes.
    [[nodiscard]] SharedArray view() {
        SharedArray out;
        out.data_ = data_;
        out.size_ = out.ready_ = out.capacity_ = size_;
        out.owns_ = false;
        return out;
    }

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] std::size_t capacity() const { return capacity_; }
    [[nodiscard]] bool empty() const { return size_ == 0; }
    [[nodiscard]] T* data() { return data_; }
    [[nodiscard]] const T* data() const { return data_; }
    [[nodiscard]] T& operator[](std::size_t i) { return data_[i]; }
    [[nodiscard]] const T& operator[](std::size_t i) const { return data_[i]; }
    [[nodiscard]] T& back() { return data_[size_ - 1]; }
    [[nodiscard]] T* begin() { return data_; }
    [[nodiscard]] T* end() { return data_ + size_; }
    [[nodiscard]] const T* begin() const { return data_; }
    [[nodiscard]] const T* end() const { return data_ + size_; }

    void push_back(const T& value) {
        if (size_ == ready_) {
            const T kept = value;  // it may be one of ours
            if (size_ == capacity_) reserve(std::max<std::size_t>(16, size_ + size_ / 2));
            ready(size_ + 1);
            data_[size_++] = kept;
            return;
        }
        data_[size_++] = value;
    }
    void resize(std::size_t n, const T& value) {
        const std::size_t before = size_;
        resize_as_is(n);
        if (n > before) std::fill(data_ + before, data_ + n, value);
    }
    /// New elements hold anything.
    void resize_as_is(std::size_t n) {
        if (n > capacity_) reserve(std::max(n, size_ + size_ / 2));
        if (n > ready_) ready(n);
        size_ = n;
    }
    /// For a worker, before it writes to `count` new elements that nobody has touched: see touch_pages(). A view, which knows of a part only, does nothing.
    void touch(std::size_t first, std::size_t count) {
        if (owns_ && is_paged(capacity_)) touch_pages(data_, capacity_ * sizeof(T), first * sizeof(T), (first + count) * sizeof(T));
    }
    void assign(std::size_t n, const T& value) {
        size_ = 0;
        resize(n, value);
    }
    void clear() { size_ = 0; }
    /// Gives the memory back.
    void release() {
        give_back();
        data_ = nullptr;
        size_ = ready_ = capacity_ = 0;
        owns_ = true;
    }
    void reserve(std::size_t n) {
        if (n <= capacity_) return;
        WELLMESH_CHECK(Stage::delaunay, owns_);
        if (data_ != nullptr && is_paged(capacity_)) {
            data_ = static_cast<T*>(grow_pages(data_, capacity_ * sizeof(T), n * sizeof(T)));
        } else {
            T* const grown = static_cast<T*>(is_paged(n) ? take_pages(n * sizeof(T)) : ::operator new(n * sizeof(T), kAlignment));
            if (size_ != 0) std::copy_n(data_, size_, grown);
            give_back();
            data_ = grown;
            ready_ = size_;
        }
        capacity_ = n;
    }

private:
    static constexpr std::align_val_t kAlignment{std::max<std::size_t>(alignof(T), 64)};
    static constexpr bool is_paged(std::size_t n) { return kPagesMove && n * sizeof(T) >= kLeastPaged; }
    /// The first n may be touched: size() grows up to ready_ without a further look.
    void ready(std::size_t n) {
        ready_ = is_paged(capacity_) ? std::min(capacity_, ready_pages(data_, capacity_ * sizeof(T), ready_ * sizeof(T), n * sizeof(T)) / sizeof(T)) : capacity_;
    }
    void give_back() {
        if (!owns_ || data_ == nullptr) return;
        if (is_paged(capacity_)) give_back_pages(data_, capacity_ * sizeof(T));
        else ::operator delete(data_, kAlignment);
    }
    T* data_ = nullptr;
    std::size_t size_ = 0, ready_ = 0, capacity_ = 0;
    bool owns_ = true;
};

}  // namespace wellmesh
