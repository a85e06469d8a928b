// A design that Yosys wrote as C++ (CXXRTL), as the run loop's Machine.
//
// Stands behind the generated design and, generated too:
//   INPUTS(X), OUTPUTS(X)   X(index, member, offset) for each port the design has
//   CLOCKS(X)               X(index, member, member that holds the clock's previous level)
//   STATE(X)                X(member) for each wire and memory
//   kInputs, kOutputs, kClocks, kSingle, kSettle in namespace railgate

#include <cstdint>
#include <map>
#include <string>

namespace railgate {

using namespace cxxrtl_yosys;

struct Unobserved {
    template <class... Update>
    void on_update(Update...) {}
};

// The up to 64 bits from a multiple of 64; none above the width may be set.
template <size_t Offset = 0, size_t Bits>
void put(value<Bits> &to, uint64_t bits) {
    to.data[Offset / 32] = uint32_t(bits);
    if constexpr (Bits > Offset + 32)
        to.data[Offset / 32 + 1] = uint32_t(bits >> 32);
}

template <size_t Offset, size_t Bits>
uint64_t get(const value<Bits> &from) {
    uint64_t bits = from.data[Offset / 32];
    if constexpr (Bits > Offset + 32)
        bits |= uint64_t{from.data[Offset / 32 + 1]} << 32;
    return bits;
}

template <size_t Offset, size_t Bits>
uint64_t get(const wire<Bits> &from) {
    return get<Offset>(from.curr);
}

// Unlike wire::commit it does not look for a difference first: copying is cheaper than the branch.
template <size_t Bits>
void latch(wire<Bits> &to) {
    to.curr = to.next;
}

template <size_t Bits>
void latch(memory<Bits> &to) {
    Unobserved nobody;
    if (!to.write_queue.empty())
        to.commit(nobody);
}

template <class F, size_t Bits>
void visit_member(F &f, value<Bits> &held) {
    f(held.data, sizeof held.data);
}

template <class F, size_t Bits>
void visit_member(F &f, wire<Bits> &held) {
    visit_member(f, held.curr);
    visit_member(f, held.next);
}

template <class F, size_t Bits>
void visit_member(F &f, memory<Bits> &held) {
    for (size_t i = 0; i < held.depth; i++)
        visit_member(f, held.data[i]);
}

class Machine {
public:
    // Clocks rest at 1; a previous level of 0 arms an edge, so no step is spent on falling edges.
    Machine() {
#define X(i, clock, before) put(top_.clock, 1), put(top_.before, 1);
        CLOCKS(X)
#undef X
    }

    void input(size_t i, uint64_t bits) {
        switch (i) {
#define X(i, port, offset) \
    case i: put<offset>(top_.port, bits); break;
            INPUTS(X)
#undef X
        }
    }

    template <size_t I>
    uint64_t output() const {
#define X(i, port, offset) \
    if constexpr (I == i) return get<offset>(top_.port);
        OUTPUTS(X)
#undef X
        return 0;
    }

    // One pass gives both the outputs of the present state and the registers' next one.
    __attribute__((always_inline)) void evaluate([[maybe_unused]] uint64_t armed) {
        if constexpr (kSettle)
            do
                top_.p_top::eval();
            while (top_.commit());
#define X(i, clock, before) put(top_.before, !(armed >> i & 1));
        CLOCKS(X)
#undef X
        top_.p_top::eval();
    }

    __attribute__((always_inline)) void commit(uint64_t) {
#define X(member) latch(top_.member);
        STATE(X)
#undef X
#define X(i, clock, before) put(top_.before, 1);
        CLOCKS(X)
#undef X
    }

    template <class F>
    void visit(F &f) {
#define X(member) visit_member(f, top_.member);
        STATE(X)
#undef X
#define X(i, port, offset) if constexpr (offset == 0) visit_member(f, top_.port);
        INPUTS(X)
#undef X
    }

    // Names that mean the same register are all there: an alias has no next value of its own.
    template <class F>
    void registers(F f) {
        debug_items items;
        top_.debug_info(&items, nullptr, "");
        std::map<uint32_t *, uint32_t *> next;
        for (auto &[name, parts] : items.table)
            for (debug_item &part : parts)
                if (part.type == debug_item::WIRE && part.flags & debug_item::DRIVEN_SYNC)
                    next[part.curr] = part.next;
        for (auto &[name, parts] : items.table)
            if (parts.size() == 1 && parts[0].width <= 64 && next.count(parts[0].curr)) {
                std::string line = name + " " + std::to_string(parts[0].width);
                f(line, {parts[0].curr, next[parts[0].curr], uint32_t(parts[0].width)});
            }
    }

private:
    cxxrtl_design::p_top top_;
};

}  // namespace railgate
