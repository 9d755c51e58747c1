/* SPDX-License-Identifier: MIT */
/* parts.h - the parts of the force, which the calls force and jvp of integrator.h take. */
#ifndef CLOTHSIM_PARTS_H
#define CLOTHSIM_PARTS_H

/* Parts of the force, so that a method can split it.
 *
 * `parts` of force and jvp is a set of these bits, and the sum is that of the forces in the
 * set. Some forces have a bit of their own. All others share three bits, by what they are, so
 * that a force which is new to the program is right in every method, also in a module that was
 * built before. A method should therefore name forces by the masks below, and take `all except`
 * as CS_PART_ALL & ~mask: a list of bits of its own would leave out what it does not know. */
enum cs_part {
    /* Forces with a bit of their own. */
    CS_PART_STRETCH = 1u << 0, /* springs along the threads; edges of a mesh */
    CS_PART_SHEAR = 1u << 1,   /* springs across the cells; inside a mesh */
    CS_PART_BEND = 1u << 2,    /* springs over two cells; across the edges of a mesh */
    CS_PART_DAMPING = 1u << 3, /* the dampers of the springs */
    CS_PART_GRAVITY = 1u << 4, /* m g: has an energy, and no derivative */
    CS_PART_DRAG = 1u << 5,    /* -c v of still air */
    CS_PART_WIND = 1u << 6,    /* pressure on the cloth; has a jvp, is not in the matrix */

    /* All others, by what they are. */
    CS_PART_POTENTIAL = 1u << 7,   /* minus the slope of an energy; in the matrix */
    CS_PART_DISSIPATIVE = 1u << 8, /* against a velocity; no energy, in the matrix */
    CS_PART_EXTERNAL =
        1u << 9, /* neither energy nor in the matrix: impacts, viewpoint forces */

    /* Membranes and their bending: with bits of their own too. */
    CS_PART_ELASTIC = 1u << 10,
    CS_PART_ELASTIC_DAMPING = 1u << 11,

    /* The elastic springs, and those with their dampers. */
    CS_PART_SPRINGS = CS_PART_STRETCH | CS_PART_SHEAR | CS_PART_BEND,
    CS_PART_DAMPED_SPRINGS = CS_PART_SPRINGS | CS_PART_DAMPING,

    /* What holds a body together: springs, membranes and bending, with their dampers. */
    CS_PART_INTERNAL = CS_PART_DAMPED_SPRINGS | CS_PART_ELASTIC | CS_PART_ELASTIC_DAMPING,

    /* What host->energy holds beside the kinetic energy. The rest does work that no energy
     * knows of: a line search on the energy takes it as constant. */
    CS_PART_WITH_ENERGY =
        CS_PART_SPRINGS | CS_PART_ELASTIC | CS_PART_GRAVITY | CS_PART_POTENTIAL,

    /* What can limit the step of an explicit method. */
    CS_PART_STIFF = CS_PART_INTERNAL | CS_PART_POTENTIAL | CS_PART_DISSIPATIVE,

    /* What host->solve and host->diagonal hold: what can be stiff, and drag. */
    CS_PART_LINEARISED = CS_PART_STIFF | CS_PART_DRAG,

    /* What moves a free body as a whole, neither stiffness nor damping: m g, and impacts. */
    CS_PART_FREE_FALL = CS_PART_GRAVITY | CS_PART_EXTERNAL,

    /* Every force, also those of later hosts. */
    CS_PART_ALL = 0x7fffffff,

    /* All others: for methods that treat those by a model or a step of their own. */
    CS_PART_OUTER = CS_PART_ALL & ~CS_PART_INTERNAL,
    CS_PART_WITHOUT_ENERGY = CS_PART_ALL & ~CS_PART_WITH_ENERGY
};

#endif
