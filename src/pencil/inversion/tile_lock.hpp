// Holds a tile against other threads.
#pragma once

#include "pencil/inversion/ray_tiles.hpp"

#include <atomic>

namespace raywise::detail {

class TileLock {
public:
    TileLock(Tile& tile, bool is_shared) : tile_(is_shared ? &tile : nullptr) {
        while (tile_ != nullptr && tile_->busy.exchange(true, std::memory_order_acquire))
            while (tile_->busy.load(std::memory_order_relaxed)) {
            }
    }
    ~TileLock() {
        if (tile_ != nullptr) tile_->busy.store(false, std::memory_order_release);
    }
    TileLock(const TileLock&) = delete;
    TileLock& operator=(const TileLock&) = delete;
    TileLock(TileLock&&) = delete;
    TileLock& operator=(TileLock&&) = delete;

private:
    Tile* tile_;
};

} // namespace raywise::detail
