// The run loop of a compiled design, and its C interface.
//
// Stands behind the definition of `Machine`, one per simulator:
//   kInputs, kOutputs, kClocks   how many of each
//   kSingle                      one clock, an active edge in every tick
//   input(i, value)              drive input i
//   output(i)                    the bits of output i, i a compile-time constant
//   evaluate(armed)              settle; the clocks of the mask `armed` have their edge next
//   commit(armed)                take these edges
//   visit(f)                     f(pointer, bytes) for every piece of state
//   registers(f)                 f(name, width, current chunks, next chunks)

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace railgate {

using u128 = unsigned __int128;

struct Wave {
    const int64_t *ticks;
    const uint64_t *values;
    int64_t size;
};

// Edge times are tick + rest / divisor, exact: the steps' remainders are carried, never rounded.
struct Clock {
    int64_t tick, step;
    u128 rest, step_rest, divisor;

    int64_t edge() const { return tick + (rest != 0); }

    void advance() {
        tick += step;
        rest += step_rest;
        if (rest >= divisor) {
            rest -= divisor;
            tick++;
        }
    }
};

struct Channel {
    std::vector<int64_t> ticks;
    std::vector<uint64_t> values;
};

struct Register {
    uint32_t *current, *next;
    uint32_t width;
};

constexpr int64_t kNever = std::numeric_limits<int64_t>::max();

class Engine {
public:
    explicit Engine(const void *clocks) {
        std::memcpy(clocks_.data(), clocks, sizeof clocks_);
        machine_.registers([this](const std::string &name, Register found) {
            names_ += name + "\n";
            registers_.push_back(found);
        });
    }

    void run(int64_t until, const Wave *waves, const uint8_t *wanted) {
        std::copy_n(wanted, kOutputs, wanted_.begin());
        for (Channel &channel : channels_) {
            channel.ticks.clear();
            channel.values.clear();
        }
        std::array<int64_t, kInputs + 1> cursors{};
        fresh_ = 1;
        if (now_ == until)
            tick<false>(until, 0);
        while (now_ < until) {
            int64_t stop = std::min(apply(waves, cursors.data()), until);
            if constexpr (kSingle)
                while (now_ < stop)
                    tick<true>(now_ + 1, ~uint64_t{0});
            else
                while (now_ < stop)
                    leap(stop);
        }
    }

    template <class F>
    void visit(F f) {
        f(&now_, sizeof now_);
        f(clocks_.data(), sizeof clocks_);
        machine_.visit(f);
    }

    const Channel &channel(size_t i) const { return channels_[i]; }
    const std::string &names() const { return names_; }

    void poke(size_t i, uint64_t value) {
        const Register &found = registers_[i];
        for (uint32_t bit = 0; bit < found.width; bit += 32)
            found.current[bit / 32] = found.next[bit / 32] = uint32_t(value >> bit);
    }

private:
    int64_t apply(const Wave *waves, int64_t *cursors) {
        int64_t next = kNever;
        for (size_t i = 0; i < kInputs; i++) {
            int64_t &at = cursors[i];
            if (at < waves[i].size && waves[i].ticks[at] <= now_)
                machine_.input(i, waves[i].values[at++]);
            if (at < waves[i].size)
                next = std::min(next, waves[i].ticks[at]);
        }
        return next;
    }

    template <bool Edge>
    __attribute__((always_inline)) void tick(int64_t next, uint64_t armed) {
        machine_.evaluate(armed);
        observe(std::make_index_sequence<kOutputs>{});
        if (Edge)
            machine_.commit(armed);
        now_ = next;
    }

    void leap(int64_t stop) {
        int64_t next = stop;
        for (const Clock &clock : clocks_)
            next = std::min(next, clock.edge());
        uint64_t armed = 0;
        for (size_t i = 0; i < kClocks; i++)
            if (clocks_[i].edge() == next) {
                armed |= uint64_t{1} << i;
                clocks_[i].advance();
            }
        tick<true>(next, armed);
    }

    template <size_t... I>
    __attribute__((always_inline)) void observe(std::index_sequence<I...>) {
        uint64_t changed = fresh_;
        ((changed |= machine_.template output<I>() ^ last_[I]), ...);
        if (__builtin_expect(changed != 0, 0))
            (record(I, machine_.template output<I>()), ...), fresh_ = 0;
    }

    __attribute__((noinline)) void record(size_t i, uint64_t value) {
        if (!fresh_ && value == last_[i])
            return;
        last_[i] = value;
        if (!wanted_[i])
            return;
        channels_[i].ticks.push_back(now_);
        channels_[i].values.push_back(value);
    }

    Machine machine_;
    int64_t now_ = 0;
    uint64_t fresh_ = 1;
    std::array<uint64_t, kOutputs + 1> last_{};
    std::array<uint8_t, kOutputs + 1> wanted_{};
    std::array<Clock, kClocks> clocks_;
    std::array<Channel, kOutputs> channels_;
    std::vector<Register> registers_;
    std::string names_;
};

}  // namespace railgate

#define RAILGATE_API extern "C" __attribute__((visibility("default")))

using railgate::Engine;

// clocks: per clock tick, step, then rest, step_rest, divisor of 128 bits, little-endian.
RAILGATE_API Engine *railgate_open(const void *clocks) { return new Engine(clocks); }

RAILGATE_API void railgate_close(Engine *engine) { delete engine; }

// wanted: per output whether its changes are kept. counts: how many it had then. Returns their sum.
RAILGATE_API int64_t railgate_run(Engine *engine, int64_t until, const railgate::Wave *waves,
                                  const uint8_t *wanted, int64_t *counts) {
    engine->run(until, waves, wanted);
    int64_t sum = 0;
    for (size_t i = 0; i < railgate::kOutputs; i++)
        sum += counts[i] = int64_t(engine->channel(i).ticks.size());
    return sum;
}

// The changes of all outputs of the last run, one output after the other.
RAILGATE_API void railgate_take(Engine *engine, int64_t *ticks, uint64_t *values) {
    for (size_t i = 0; i < railgate::kOutputs; i++) {
        const railgate::Channel &channel = engine->channel(i);
        ticks = std::copy(channel.ticks.begin(), channel.ticks.end(), ticks);
        values = std::copy(channel.values.begin(), channel.values.end(), values);
    }
}

RAILGATE_API int64_t railgate_size(Engine *engine) {
    size_t size = 0;
    engine->visit([&](const void *, size_t bytes) { size += bytes; });
    return int64_t(size);
}

RAILGATE_API void railgate_save(Engine *engine, uint8_t *to) {
    engine->visit([&](const void *from, size_t bytes) {
        std::memcpy(to, from, bytes);
        to += bytes;
    });
}

RAILGATE_API void railgate_load(Engine *engine, const uint8_t *from) {
    engine->visit([&](void *to, size_t bytes) {
        std::memcpy(to, from, bytes);
        from += bytes;
    });
}

// "name width" of each register that can be poked, a line each.
RAILGATE_API const char *railgate_registers(Engine *engine) { return engine->names().c_str(); }

RAILGATE_API void railgate_poke(Engine *engine, int64_t i, uint64_t value) {
    engine->poke(size_t(i), value);
}
