/*
 * Runs the policy of policy.h: observations from standard input, actions to standard output, as the bytes of floats. With an
 * argument, prints its contract instead, each part ended by a zero.
 */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "policy.h"

static void print_text(const char *text)
{
    printf("%s%c", text, 0);
}

static void print_time(unsigned long us)
{
    printf("%lu%c", us, 0);
}

static void print_bits(float number)
{
    uint32_t bits;
    memcpy(&bits, &number, sizeof bits);
    printf("%08lx%c", (unsigned long)bits, 0);
}

static void print_contract(void)
{
    print_text(TED_POLICY_TASK);
    print_time(TED_POLICY_CONTROL_PERIOD_US);
    print_time(TED_POLICY_MAX_OBSERVATION_AGE_US);
    print_time(TED_POLICY_DECLARED);
    for (int i = 0; i < TED_POLICY_OBSERVATION; ++i) {
        const ted_policy_observation_channel *it = &ted_policy_observation_channels[i];
        print_text(it->name);
        print_text(it->unit);
        print_bits(it->low);
        print_bits(it->high);
    }
    for (int i = 0; i < TED_POLICY_ACTION; ++i) {
        const ted_policy_action_channel *it = &ted_policy_action_channels[i];
        print_text(it->name);
        print_text(it->unit);
        print_bits(it->low);
        print_bits(it->high);
        print_bits(it->slew_per_tick);
        if (it->on_fault == TED_POLICY_VALUE) {
            print_bits(it->on_fault_value);
        } else {
            print_text(it->on_fault == TED_POLICY_ZERO ? "zero" : "hold-last");
        }
    }
}

int main(int count, char **arguments)
{
    float observation[TED_POLICY_OBSERVATION];
    float action[TED_POLICY_ACTION];
    (void)arguments;
    if (count > 1) {
        print_contract();
        return 0;
    }
    while (fread(observation, sizeof observation, 1, stdin) == 1) {
        ted_policy_act(observation, action);
        if (fwrite(action, sizeof action, 1, stdout) != 1) {
            return 1;
        }
    }
    return 0;
}
