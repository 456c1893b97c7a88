# Bed of spheres in a box open above: Hertz's contacts with Tsuji's dashpot, Mindlin's springs with their history.
# SPHERES=spheres.csv LENGTH=L STEPS=N OUT=final.csv yade -x -n -j1 bed_yade.py
import os
import time

length, steps = float(os.environ['LENGTH']), int(os.environ['STEPS'])
glass = O.materials.append(FrictMat(young=1e7, poisson=0.25, density=2500, frictionAngle=atan(0.5)))
spheres = []
for line in open(os.environ['SPHERES']):
    cells = line.split(',')
    if cells[0] == 'x_m':
        continue
    x = [float(cell) for cell in cells[:10]]
    body = sphere(x[:3], x[3], material=glass)
    body.state.vel, body.state.angVel = x[4:7], x[7:10]
    spheres.append(O.bodies.append(body))
for axis, place, sense in [(0, 0.0, 1), (0, length, -1), (1, 0.0, 1), (1, length, -1), (2, 0.0, 1)]:
    O.bodies.append(wall(place, axis=axis, sense=sense, material=glass))
O.dt = 1e-5
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()]),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
                    [Ip2_FrictMat_FrictMat_MindlinPhys(en=0.6, es=0.6, frictAngle=MatchMaker(algo='val', val=atan(0.5)))],
                    [Law2_ScGeom_MindlinPhys_Mindlin()]),
    NewtonIntegrator(gravity=(0, 0, -9.81), damping=0.0),
]
O.run(2, wait=True)  # the first steps build tables
start = time.time()
O.run(steps, wait=True)
print('Loop time of %.6f' % (time.time() - start))
with open(os.environ['OUT'], 'w') as out:
    out.write('x_m,y_m,z_m,radius_m,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s\n')
    for k in spheres:
        state = O.bodies[k].state
        numbers = list(state.pos) + [O.bodies[k].shape.radius] + list(state.vel) + list(state.angVel)
        out.write(','.join('%.17g' % n for n in numbers) + '\n')
