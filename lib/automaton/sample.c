/* Samples: see proof.h. */
#include "proof.h"

#include <math.h>

#include "numeric/field.h"

bool definition_is_structural(const struct definition *definition)
{
    for (size_t i = 0; i < definition->argument_count; i++)
        if (definition->structural[i])
            return true;
    return false;
}

/* A number k/8 in 1..17/8, known in both ways: what an argument such as a knot interval may well be. */
static struct value small_fraction(uint64_t *state)
{
    return value_divide(value_from_integer((int64_t)(8 + field_random(state) % 10)), value_from_integer(8));
}

/* A number in the parameter's range, or near its value. */
static struct value somewhere(const struct parameter *parameter, uint64_t *state)
{
    double share = (double)(field_random(state) % 15 + 1) / 16;
    if (parameter->has_range)
        return value_from_real(parameter->low + share * (parameter->high - parameter->low));
    double real = parameter->value.real;
    return value_from_real(real + (share - 0.5) * fmax(1, fabs(real)));
}

static struct value parameter_value(const struct parameter *parameter, enum sample_kind kind, uint64_t *state)
{
    struct value value = parameter->value;
    if (parameter->is_set || parameter->structural)
        return value;
    if (kind == SAMPLE_PROVING)
        return (struct value){value.real, field_random(state), true, false};
    return kind == SAMPLE_WITNESS ? somewhere(parameter, state) : value;
}

static struct value argument_value(enum sample_kind kind, uint64_t *state)
{
    if (kind == SAMPLE_ACTUAL)
        return value_from_integer(1);
    struct value value = small_fraction(state);
    if (kind == SAMPLE_PROVING)
        return (struct value){value.real, field_random(state), true, false};
    return value;
}

bcifs_status sample_take(const bcifs_automaton *automaton, const struct definition *definition,
                         const struct value *fixed, enum sample_kind kind, uint64_t seed, struct arena *arena,
                         struct report *report, struct sample *sample)
{
    uint64_t state = (seed + 1) * UINT64_C(0x5851f42d4c957f2d);
    sample->parameters = arena_new(arena, automaton->parameter_count, sizeof *sample->parameters);
    sample->arguments = arena_new(arena, definition->argument_count, sizeof *sample->arguments);
    if (!sample->parameters || !sample->arguments)
        return report ? report_memory(report) : BCIFS_MEMORY;
    for (size_t i = 0; i < automaton->parameter_count; i++)
        sample->parameters[i] = parameter_value(&automaton->parameters[i], kind, &state);
    for (size_t i = 0; i < definition->argument_count; i++) {
        sample->arguments[i] = argument_value(kind, &state);
        if (fixed && definition->structural[i])
            sample->arguments[i] = fixed[i];
    }
    sample->setting = (struct setting){automaton, sample->parameters, report, kind == SAMPLE_PROVING};
    sample->key = (struct state_key){definition, sample->arguments};
    return BCIFS_OK;
}
