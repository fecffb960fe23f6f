// sample_types.hpp - The types a volume's samples may have, as volume.py lists them.
#pragma once

#include <cstdint>

// use(Sample) for each of them: to instantiate what is declared for any sample.
#define ISOCORE_FOR_EACH_SAMPLE_TYPE(use)                                                                        \
    use(std::uint8_t) use(std::int8_t) use(std::uint16_t) use(std::int16_t) use(std::uint32_t) use(std::int32_t) \
        use(float) use(double)

namespace isocore {

// visit<Sample>() for each of them.
template <class Visit>
void for_each_sample_type(const Visit& visit) {
#define ISOCORE_VISIT(Sample) visit.template operator()<Sample>();
    ISOCORE_FOR_EACH_SAMPLE_TYPE(ISOCORE_VISIT)
#undef ISOCORE_VISIT
}

}  // namespace isocore
