/* Notes whether linear theory and runs include contact, and what energy contact holds. */
#include "study/stability/stability_state.h"

#include "model/contact/collider_params.h"
#include "scene/body_pairs.h"
#include "study/contact_capacity.h"

#include <math.h>

void cs_contact_note_add(const struct cs_scene *scene, const char *before,
                         struct cs_text *out) {
    if (scene->colliders.n > 0 || cs_scene_has_body_contact(scene))
        cs_text_add(out, "%s%s", before,
                    scene->contact.law == CS_CONTACT_FORCE
                        ? "contact is a force, in linear theory and in runs"
                        : "contact is off in linear theory; in runs it acts after each step");
}

/* True if a collider has a friction coefficient above 0. */
static bool any_friction(const struct cs_scene *scene) {
    for (uint32_t c = 0; c < scene->colliders.n; c++)
        if (cs_scene_colliders(scene)[c].friction > 0)
            return true;
    return false;
}

/* Near rest the friction force is about mu N v / friction_speed: a damping rate of mu N / (m
 * friction_speed). A step that is too long for it turns the sliding velocity round each time,
 * and leaves it at half of what friction can change in a step. */
void cs_contact_note_add_crossing(const struct cs_system *system, double speed,
                                  struct cs_text *out) {
    const struct cs_scene *scene = system->scene;
    struct cs_contact_capacity capacity;
    double heaviest = 0;
    if (!cs_contact_capacity_find(system, &capacity))
        return;
    for (uint32_t i = 0; i < system->view.n; i++)
        if (system->inv_mass[i] > 0)
            heaviest = fmax(heaviest, system->mass[i]);
    // what may come by the scene's start, then what came in the runs
    cs_contact_capacity_print(system, &capacity, out);
    if (speed > 0)
        cs_text_add(out, "; a particle of the runs has at most %.3g J: %.3g kg at %.3g m/s",
                    0.5 * heaviest * speed * speed, heaviest, speed);
    cs_text_add(out, "\n");
    struct cs_text warning = {0};
    cs_contact_capacity_warn(system, &warning);
    if (warning.length)
        cs_text_add(out, "warning: %s\n", cs_text_get(&warning));
    cs_text_finish(&warning);
    double stiffest = 0;
    for (uint32_t c = 0; system->collider_params && c < scene->colliders.n; c++)
        stiffest = fmax(stiffest, system->collider_params[c].k);
    if (stiffest > 0 && any_friction(scene) &&
        scene->contact.friction_law == CS_FRICTION_BRISTLES)
        cs_text_add(out,
                    "friction that sticks holds a particle by %.3g N/m and %.3g N s/m, "
                    "which limits explicit steps\n",
                    stiffest, 2 * sqrt(stiffest * heaviest));
    else if (any_friction(scene))
        cs_text_add(
            out,
            "friction under a load N damps a particle of m kg at up to mu N/(m %.3g m/s): in "
            "steps above 2 over that explicit methods let it chatter, by mu N dt/(2 m) at "
            "most; what rests on a slope of half of mu creeps by %.2g mm in 30 s, with an "
            "implicit method and a friction_speed of 5e-6 m/s by 0.09 mm\n",
            scene->contact.friction_speed, 30e3 * 0.57735 * scene->contact.friction_speed);
}
