# Spheres hit a plane: CASE=linear|oblique|tsuji JOBS="step steps file-of-places-and-velocities file-of-rebounds" yade -x -n -j1 precision_yade.py
# prints seconds of processor time of the steps; JOBS: "STEP STEPS DATA OUT", separated by ";".
import os
import time

case = os.environ['CASE']


def materials():
    if case == 'tsuji':
        return FrictMat(young=7.5e7, poisson=0.0, density=DENSITY, frictionAngle=0.0)
    # A contact has half of what each of its two materials has.
    return ViscElMat(kn=2e5, cn=2 * 23.601777105523994, ks=1.6e5 if case == 'oblique' else 0.0, cs=0.0,
                     density=DENSITY, frictionAngle=atan(0.3) if case == 'oblique' else 0.0)


DENSITY = 7161.9724391352911
for job in os.environ['JOBS'].split(';'):
    step, steps, data, out = job.split()
    O.reset()
    matter = O.materials.append(materials())
    spheres = []
    for line in open(data):
        x = [float(cell) for cell in line.split()]
        body = sphere(x[:3], 0.01, material=matter)
        body.state.vel = x[3:]
        spheres.append(O.bodies.append(body))
    O.bodies.append(wall(0.0, axis=2, sense=1, material=matter))
    O.dt = float(step)
    if case == 'tsuji':
        loop = InteractionLoop([Ig2_Wall_Sphere_ScGeom()], [Ip2_FrictMat_FrictMat_MindlinPhys(en=0.5, es=0.5)],
                               [Law2_ScGeom_MindlinPhys_Mindlin()])
    else:
        loop = InteractionLoop([Ig2_Wall_Sphere_ScGeom()], [Ip2_ViscElMat_ViscElMat_ViscElPhys()],
                               [Law2_ScGeom_ViscElPhys_Basic()])
    O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()], verletDist=0.001), loop,
                 NewtonIntegrator(damping=0.0)]
    start = time.process_time()
    O.run(int(steps), wait=True)
    print('Loop time of %.9f' % (time.process_time() - start))
    with open(out, 'w') as file:
        for k in spheres:
            state = O.bodies[k].state
            file.write('%.17g %.17g %.17g\n' % (state.vel[2], state.vel[0], state.angVel[1]))
