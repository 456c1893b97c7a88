# Tables of spheres (x, y, z, radius, velocities, spins) as a file for read_data of LAMMPS and LIGGGHTS. Variables: density, low and
# high (corners of the box, three numbers each). Files: of the first type, then of the second.
BEGIN { FS = ","; split(low, l, " "); split(high, h, " ") }
FNR == 1 { type++; next }
{ line[++n] = $0; of[n] = type }
END {
    print "spheres\n"
    print n, "atoms\n" type, "atom types\n"
    print l[1], h[1], "xlo xhi\n" l[2], h[2], "ylo yhi\n" l[3], h[3], "zlo zhi\n\nAtoms\n"
    for (k = 1; k <= n; k++) {
        split(line[k], c, ",")
        printf "%d %d %.17g %.17g %s %s %s\n", k, of[k], 2 * c[4], density, c[1], c[2], c[3]
    }
    print "\nVelocities\n"
    for (k = 1; k <= n; k++) {
        split(line[k], c, ",")
        print k, c[5], c[6], c[7], c[8], c[9], c[10]
    }
}
