# The last frame of a dump (x y z radius, velocities, spins, type) as a table of the spheres of type 1.
BEGIN { print "x_m,y_m,z_m,radius_m,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s" }
/^ITEM: TIMESTEP/ { n = 0; inside = 0 }
/^ITEM: ATOMS/ { inside = 1; next }
inside && $11 == 1 { row[++n] = $1 "," $2 "," $3 "," $4 "," $5 "," $6 "," $7 "," $8 "," $9 "," $10 }
END { for (k = 1; k <= n; k++) print row[k] }
